#include "scenario/toml_depth.hpp"

#include <algorithm>
#include <vector>

namespace knap {
namespace {

/// Reads as much of the grammar as says how deep a place is: strings, comments, brackets, dots and what ends a key.
class DepthReader {
public:
    explicit DepthReader(std::string_view text) : text_(text) {}

    std::optional<Place> too_deep() {
        for (; at_ < text_.size() && depth() <= deepest_nesting; ++at_) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') skip_string(c);
            else if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
            else see(c);
        }
        if (depth() <= deepest_nesting) return std::nullopt;
        const std::string_view before = text_.substr(0, at_ - 1);
        const auto begin = before.rfind('\n') + 1;  // 0 where there is none
        return Place{.line = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')), .column = 1 + static_cast<int>(before.size() - begin), .length = 1};
    }

private:
    int depth() const { return (open_.empty() ? table_ : open_.back()) + key_ + dots_; }

    void see(char c) {
        switch (c) {
            case '.': ++dots_; break;
            case '=': end_key(dots_ + 1); break;
            case ',': end_key(0); break;
            case '\n':
                if (open_.empty()) end_key(0);
                break;
            case '[':
            case '{':
                if (open_.empty() && key_ == 0) {  // [table]
                    table_ = 0, in_name_ = true;
                } else {
                    open_.push_back(open_.empty() ? table_ + key_ : open_.back() + std::max(key_, 1));
                    end_key(0);
                }
                break;
            case ']':
            case '}':
                if (in_name_) table_ = dots_ + 1, in_name_ = false;
                else if (!open_.empty()) open_.pop_back();
                end_key(0);
                break;
            default: break;
        }
    }

    void end_key(int n_parts) { key_ = n_parts, dots_ = 0; }

    /// To the quote that ends it.
    void skip_string(char quote) {
        const std::string three(3, quote);
        const bool long_one = text_.substr(at_, 3) == three;
        at_ += long_one ? 3 : 1;
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\\' && quote == '"') ++at_;
            else if (long_one && text_.substr(at_, 3) == three) break;
            else if (!long_one && (text_[at_] == quote || text_[at_] == '\n')) break;
        }
        if (long_one) at_ = std::min(at_ + 2, text_.size());
    }

    std::string_view text_;
    std::size_t at_ = 0;
    std::vector<int> open_;  // depth of what is in every open bracket
    int table_ = 0;          // depth of the table that is written
    int key_ = 0;            // parts of the key whose value is read
    int dots_ = 0;           // of a key, or of a number
    bool in_name_ = false;   // of a table
};

}  // namespace

std::optional<Place> too_deep(std::string_view text) { return DepthReader(text).too_deep(); }

}  // namespace knap
