#include "stepper/implicit/frontal_factor.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The faster one of those that this machine can run.
FrontKernel fastest_kernel_of_fronts() {
#ifdef KNAP_AVX2
    if (__builtin_cpu_supports("avx2")) return avx2_front_kernel();
#endif
    return baseline_front_kernel();
}

}  // namespace

FrontalFactor::FrontalFactor(const Dissection& dissection, std::size_t n_numbers)
    : kernel_(fastest_kernel_of_fronts()),
      dissection_(dissection),
      fronts_(dissection.parts.size()),
      stale_(fronts_.size(), true),
      place_(n_numbers, -1),
      local_(n_numbers) {
    own_.reserve(n_numbers);
    left_.reserve(n_numbers);
    row_.reserve(n_numbers);
}

bool FrontalFactor::update(const std::vector<Index>& eliminated_in, const ElementsOf& elements_of) {
    for (Index part = 0; part < static_cast<Index>(fronts_.size()); ++part) {
        if (!stale_[part]) continue;
        const Index above = dissection_.parts[part].parent;
        if (above >= 0) stale_[above] = true;
        elements_.clear();
        if (dissection_.parts[part].is_leaf()) elements_of(part, elements_);
        find_unknowns(part, eliminated_in);
        assemble(part);
        for (const Index u : fronts_[part].unknown.entries()) place_[u] = -1;
        if (!eliminate(fronts_[part])) return false;  // this front and those above it stay stale
        stale_[part] = false;
    }
    return true;
}

void FrontalFactor::find_unknowns(Index part, const std::vector<Index>& eliminated_in) {
    own_.clear();
    left_.clear();
    const auto add = [&](Index u) {
        if (u < 0 || place_[u] >= 0) return;
        place_[u] = 0;
        (eliminated_in[u] == part ? own_ : left_).push_back(u);
    };
    for (const Element& element : elements_) std::for_each_n(element.unknown.begin(), element.n_unknowns, add);
    for (const Index child : dissection_.parts[part].child)
        if (child >= 0) std::ranges::for_each(fronts_[child].left(), add);
    Front& front = fronts_[part];
    front.n_eliminated = static_cast<Index>(own_.size());
    front.unknown.resize(arena_, own_.size() + left_.size());
    const std::span<Index> unknown = front.unknown.entries();
    std::ranges::copy(left_, std::ranges::copy(own_, unknown.begin()).out);
    for (Index i = 0; i < front.size(); ++i) place_[unknown[i]] = i;
}

void FrontalFactor::assemble(Index part) {
    Front& front = fronts_[part];
    const auto set_zero = [&](ArenaList<double>& matrix, std::size_t n_rows, std::size_t n_columns) {
        matrix.resize(arena_, n_rows * n_columns + front_padding);
        std::ranges::fill(matrix.entries(), 0.0);
    };
    set_zero(front.L, front.size(), front.n_eliminated);
    set_zero(front.schur, front.n_left(), front.n_left());
    for (const Element& element : elements_)
        for (int j = 0; j < element.n_unknowns; ++j)
            for (int i = 0; i < element.n_unknowns; ++i) {
                if (element.unknown[i] < 0 || element.unknown[j] < 0) continue;
                const Index row = place_[element.unknown[i]], column = place_[element.unknown[j]];
                if (row >= column) front.at(row, column) += element.matrix(i, j);
            }
    for (const Index child : dissection_.parts[part].child) {
        if (child < 0) continue;
        const Front& half = fronts_[child];
        const Index n = half.n_left();
        row_.clear();
        for (const Index u : half.left()) row_.push_back(place_[u]);
        for (Index j = 0; j < n; ++j) {
            const double* from = half.schur.first() + n * std::size_t(j);
            const Index column = row_[j];
            for (Index i = j; i < n; ++i) front.at(std::max(row_[i], column), std::min(row_[i], column)) += from[i];
        }
    }
}

bool FrontalFactor::eliminate(Front& front) const {
    return front.n_eliminated == 0 ||
           kernel_.eliminate(front.L.first(), front.schur.first(), front.size(), front.n_eliminated);
}

void FrontalFactor::load(const Front& front, const std::vector<double>& x) {
    const Index* unknown = front.unknown.first();
    for (Index i = 0; i < front.size(); ++i) local_[i] = x[unknown[i]];
}

void FrontalFactor::substitute_in_front(const Front& front, std::vector<double>& x) {
    if (front.n_eliminated == 0) return;
    load(front, x);
    kernel_.substitute(front.L.first(), front.size(), front.n_eliminated, local_.data());
    for (Index i = 0; i < front.size(); ++i) x[front.unknown.first()[i]] = local_[i];
}

void FrontalFactor::substitute_back_in_front(const Front& front, std::vector<double>& x) {
    if (front.n_eliminated == 0) return;
    load(front, x);
    kernel_.substitute_back(front.L.first(), front.size(), front.n_eliminated, local_.data());
    for (Index i = 0; i < front.n_eliminated; ++i) x[front.unknown.first()[i]] = local_[i];
}

void FrontalFactor::substitute(std::span<const Index> parts, std::vector<double>& x) {
    for (const Index part : parts) substitute_in_front(fronts_[part], x);
}

void FrontalFactor::substitute_back(std::span<const Index> parts, std::vector<double>& x) {
    for (auto part = parts.rbegin(); part != parts.rend(); ++part) substitute_back_in_front(fronts_[*part], x);
}

void FrontalFactor::set_zero(std::span<const Index> parts, std::vector<double>& x) const {
    for (const Index part : parts)
        for (Index i = 0; i < fronts_[part].n_eliminated; ++i) x[fronts_[part].unknown.first()[i]] = 0;
}

FactorSize FrontalFactor::size() const {
    FactorSize size;
    for (const Front& front : fronts_) {
        const std::int64_t n = front.n_eliminated;
        size.unknowns += n;
        size.entries += n * (n + 1) / 2 + n * front.n_left();
    }
    return size;
}

}  // namespace knap
