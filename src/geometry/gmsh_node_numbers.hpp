#pragma once
// Finds the nodes of a Gmsh file by their tags, which need be neither ascending nor without gaps.
#include "base/vec.hpp"
#include "geometry/gmsh_file.hpp"

namespace knap {

class GmshNodeNumbers {
public:
    /// Throws UserError for a tag that is there twice.
    GmshNodeNumbers(const GmshSource& source, const std::vector<GmshNode>& nodes);

    /// Index of a node; `where` is the place that asks. Throws UserError when there is no such node.
    Index of(std::int64_t tag, std::size_t where) const;

private:
    const GmshSource& source_;
    std::vector<std::pair<std::int64_t, Index>> by_tag_;
    bool without_gaps_ = false;
};

}  // namespace knap
