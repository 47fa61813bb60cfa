#include "interface/staircase_lcp.hpp"

namespace knap {

void StaircaseLcp::add(std::size_t link, const InterfaceLaw& law, double mobility) {
    const double unit = mobility > 0 ? std::sqrt(2 / mobility) : 1;
    largest_unit_ = std::max(largest_unit_, unit);
    if (law.contact.may_touch) rows_.push_back({link, 0, 1, law.contact.rate, 0, 0, rows_.size(), 0, 0, unit});
    for (const Staircase::Kink& kink : law.staircase(law.contact.may_touch).kinks()) {
        const std::size_t first = rows_.size();
        for (const double sign : {1., -1., 0.})
            rows_.push_back({link, 1, sign, kink.rate, kink.cohesive, kink.friction, first, 0, 0, unit});
    }
}

void StaircaseLcp::add(std::size_t number, const FanLink& link, const InterfaceLaw& law, double mobility) {
    add(number, law, mobility);
    if (!(link.ramp > 0 && link.cohesive > 0)) return;
    const double unit = mobility > 0 ? std::sqrt(2 / mobility) : 1;
    const std::size_t first = rows_.size();
    for (const double sign : {1., 0.})
        rows_.push_back(
            {number, 0, sign, link.ramp - link.ramp_start.x(), 0, 0, first, link.cohesive, link.ramp, unit});
}

}  // namespace knap
