#include "stepper/implicit/frontal_factor.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <iterator>

namespace knap {

FrontalFactor::FrontalFactor(const Dissection& dissection) : dissection_(dissection), fronts_(dissection.parts.size()), stale_(fronts_.size(), true) {}

bool FrontalFactor::update(const std::vector<Index>& eliminated_in, const ElementsOf& elements_of) {
    if (place_.size() != eliminated_in.size()) make_room_for(eliminated_in.size());
    for (std::size_t part = 0; part < fronts_.size(); ++part) {
        if (!stale_[part]) continue;
        const Index above = dissection_.parts[part].parent;
        if (above >= 0) stale_[above] = true;
        elements_.clear();
        if (dissection_.parts[part].is_leaf()) elements_of(static_cast<Index>(part), elements_);
        find_unknowns(static_cast<Index>(part), eliminated_in);
        assemble(static_cast<Index>(part));
        for (const Index u : fronts_[part].unknown.entries()) place_[u] = -1;
        if (!eliminate(fronts_[part])) return false;  // this front and those above it stay stale
        stale_[part] = false;
    }
    return true;
}

void FrontalFactor::make_room_for(std::size_t n_unknowns) {
    place_.assign(n_unknowns, -1);
    for (std::vector<Index>* list : {&own_, &left_, &place_above_}) list->reserve(n_unknowns);
    local_.resize(static_cast<Eigen::Index>(n_unknowns));
}

void FrontalFactor::DenseMatrix::set_zero(Arena& arena, Index n_rows, Index n_columns) {
    n_rows_ = n_rows, n_columns_ = n_columns;
    entries_.resize(arena, static_cast<std::size_t>(n_rows_ * n_columns_));
    std::ranges::fill(entries_.entries(), 0.0);
}

void FrontalFactor::find_unknowns(Index part, const std::vector<Index>& eliminated_in) {
    Front& front = fronts_[part];
    own_.clear();
    left_.clear();
    const auto meet = [&](Index u) {
        if (u < 0 || place_[u] >= 0) return;
        place_[u] = 0;
        (eliminated_in[u] == part ? own_ : left_).push_back(u);
    };
    for (const Element& element : elements_)
        for (int i = 0; i < element.n_unknowns; ++i) meet(element.unknown[i]);
    for (const Index child : dissection_.parts[part].child) {
        if (child < 0) continue;
        for (const Index u : fronts_[child].left()) meet(u);
    }
    front.n_eliminated = static_cast<Index>(own_.size());
    front.unknown.resize(arena_, own_.size() + left_.size());
    const std::span<Index> unknown = front.unknown.entries();
    std::ranges::copy(left_, std::ranges::copy(own_, unknown.begin()).out);
    for (Index i = 0; i < front.size(); ++i) place_[unknown[i]] = i;
}

double& FrontalFactor::entry(Front& front, Index row, Index column) {
    return column < front.n_eliminated ? front.L(row, column) : front.left_over(row - front.n_eliminated, column - front.n_eliminated);
}

void FrontalFactor::assemble(Index part) {
    Front& front = fronts_[part];
    front.L.set_zero(arena_, front.size(), front.n_eliminated);
    front.left_over.set_zero(arena_, front.n_left(), front.n_left());
    for (const Element& element : elements_)
        for (int j = 0; j < element.n_unknowns; ++j) {
            if (element.unknown[j] < 0) continue;
            const Index column = place_[element.unknown[j]];
            for (int i = 0; i < element.n_unknowns; ++i) {
                if (element.unknown[i] < 0) continue;
                const Index row = place_[element.unknown[i]];
                if (row >= column) entry(front, row, column) += element.matrix(i, j);
            }
        }
    for (const Index child : dissection_.parts[part].child)
        if (child >= 0) add_left_over(fronts_[child], front);
}

void FrontalFactor::add_left_over(const Front& half, Front& front) {
    place_above_.clear();
    for (const Index u : half.left()) place_above_.push_back(place_[u]);
    for (Index j = 0; j < half.n_left(); ++j) {
        const double* from = half.left_over.column(j);
        const Index column = place_above_[j];
        for (Index i = j; i < half.n_left(); ++i) {
            const Index row = place_above_[i];
            entry(front, std::max(row, column), std::min(row, column)) += from[i];
        }
    }
}

bool FrontalFactor::eliminate(Front& front) {
    const Index n = front.n_eliminated, n_left = front.n_left();
    if (n == 0) return true;
    auto whole = front.L.map();
    auto L = whole.topRows(n);
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(L);
    if (in_place.info() != Eigen::Success || !(L.diagonal().array() > 0).all()) return false;
    if (n_left == 0) return true;
    auto L_B = whole.bottomRows(n_left);
    L.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(L_B);
    front.left_over.map().selfadjointView<Eigen::Lower>().rankUpdate(L_B, -1);
    return true;
}

void FrontalFactor::solve(std::vector<double>& x) const {
    // column by column: most fronts are too small for anything else
    const auto below = [](const double* column, Index k, Index size) -> Eigen::Map<const Eigen::VectorXd> { return {column + k + 1, size - k - 1}; };
    for (const Front& front : fronts_) {
        const Index n = front.n_eliminated, size = front.size();
        gather(front, x);
        for (Index k = 0; k < n; ++k) {
            const double* column = front.L.column(k);
            const double at = local_[k] /= column[k];
            local_.segment(k + 1, size - k - 1) -= at * below(column, k, size);
        }
        for (Index i = 0; i < size && n > 0; ++i) x[front.unknown.entries()[i]] = local_[i];
    }
    for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {
        const Index n = front->n_eliminated, size = front->size();
        gather(*front, x);
        for (Index k = n - 1; k >= 0; --k) {
            const double* column = front->L.column(k);
            const double known = below(column, k, size).dot(local_.segment(k + 1, size - k - 1));
            x[front->eliminated()[k]] = local_[k] = (local_[k] - known) / column[k];
        }
    }
}

void FrontalFactor::gather(const Front& front, const std::vector<double>& x) const {
    if (front.n_eliminated == 0) return;
    Index i = 0;
    for (const Index u : front.unknown.entries()) local_[i++] = x[u];
}

std::vector<Index> FrontalFactor::unknowns() const {
    std::vector<Index> all;
    for (const Front& front : fronts_) std::ranges::copy(front.eliminated(), std::back_inserter(all));
    return all;
}

std::int64_t FrontalFactor::n_unknowns() const {
    std::int64_t n = 0;
    for (const Front& front : fronts_) n += front.n_eliminated;
    return n;
}

std::int64_t FrontalFactor::n_entries() const {
    std::int64_t n = 0;
    for (const Front& front : fronts_) {
        const std::int64_t eliminated = front.n_eliminated;
        n += eliminated * (eliminated + 1) / 2 + eliminated * front.n_left();
    }
    return n;
}

}  // namespace knap
