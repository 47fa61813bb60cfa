#include "interface/staircase_lcp.hpp"

namespace knap {

void StaircaseLcp::add(std::size_t link, const InterfaceLaw& law, double mobility) {
    const double unit = mobility > 0 ? std::sqrt(2 / mobility) : 1;
    largest_unit_ = std::max(largest_unit_, unit);
    if (law.contact.may_touch) rows_.push_back({link, 0, 1, law.contact.rate, 0, 0, rows_.size(), unit});
    for (const Staircase::Kink& kink : law.staircase(law.contact.may_touch).kinks()) {
        const std::size_t first = rows_.size();
        for (const double sign : {1., -1., 0.})
            rows_.push_back({link, 1, sign, kink.rate, kink.cohesive, kink.friction, first, unit});
    }
}

}  // namespace knap
