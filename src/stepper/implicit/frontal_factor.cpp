#include "stepper/implicit/frontal_factor.hpp"

#include "base/parallel.hpp"
#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <numeric>
#include <utility>

namespace knap {
namespace {

/// The faster one of those that this machine can run.
FrontKernel fastest_kernel_of_fronts() {
#ifdef KNAP_AVX2
    if (__builtin_cpu_supports("avx2")) return avx2_front_kernel();
#endif
    return baseline_front_kernel();
}

constexpr Index for_threads = 128;           // unknowns of a front, parts of a body: more are shared by several
constexpr std::size_t columns_at_once = 16;  // of a thread in a large front
constexpr std::ptrdiff_t pivots_at_once = 64, rows_at_once = 32;

}  // namespace

FrontalFactor::Workspace::Workspace(std::size_t n_numbers) : place(n_numbers, -1), local(n_numbers + front_padding) {
    reserve_capacity(n_numbers, unknown, half[0].row, half[1].row, half[0].column, half[1].column);
}

FrontalFactor::FrontalFactor(const Dissection& dissection, std::size_t n_numbers)
    : kernel_(fastest_kernel_of_fronts()),
      dissection_(dissection),
      fronts_(dissection.parts.size()),
      stale_(fronts_.size(), true),
      threads_(std::ssize(fronts_) < for_threads ? Threads::one : Threads::all),
      level_(fronts_.size(), 0),
      by_level_(fronts_.size()) {
    Index n_levels = 1;
    for (std::size_t part = fronts_.size(); part-- > 0;) {  // parents come later
        if (const Index above = dissection.parts[part].parent; above >= 0) level_[part] = level_[above] + 1;
        n_levels = std::max(n_levels, level_[part] + 1);
    }
    first_of_level_.resize(n_levels + 1);
    stale_parts_.reserve(fronts_.size());
    const int n_threads = threads_ == Threads::all ? omp_get_max_threads() : 1;
    for (int i = 0; i < n_threads; ++i) workspaces_.emplace_back(n_numbers);
}

/// work(first, end) for blocks of [0, n).
template <class Work>
void FrontalFactor::divide(Threads threads, std::size_t n, std::size_t block, const Work& work) {
    if (threads == Threads::one) return work(0, n);
    for_blocks(static_cast<std::ptrdiff_t>((n + block - 1) / block),
               [&](std::ptrdiff_t i) { work(i * block, std::min(n, (i + 1) * block)); });
}

FrontalFactor::Workspace& FrontalFactor::workspace() { return workspaces_[omp_get_thread_num()]; }

void FrontalFactor::sort_by_level(std::span<const Index> parts) {
    std::ranges::fill(first_of_level_, 0);
    for (const Index part : parts) ++first_of_level_[level_[part] + 1];
    std::partial_sum(first_of_level_.begin(), first_of_level_.end(), first_of_level_.begin());
    for (const Index part : parts) by_level_[first_of_level_[level_[part]]++] = part;
    std::rotate(first_of_level_.begin(), first_of_level_.end() - 1, first_of_level_.end());
    first_of_level_[0] = 0;
}

std::span<const Index> FrontalFactor::parts_of_level(std::size_t level) const {
    return std::span(by_level_).subspan(first_of_level_[level], first_of_level_[level + 1] - first_of_level_[level]);
}

/// Leaves are not.
bool FrontalFactor::is_large(Index part) const {
    return threads_ == Threads::all && !dissection_.parts[part].is_leaf() && fronts_[part].size() >= for_threads;
}

bool FrontalFactor::update(const std::vector<Index>& eliminated_in, const ElementsOf& elements_of) {
    stale_parts_.clear();
    for (Index part = 0; part < static_cast<Index>(fronts_.size()); ++part) {
        if (!stale_[part]) continue;
        if (const Index above = dissection_.parts[part].parent; above >= 0) stale_[above] = true;
        stale_parts_.push_back(part);
    }
    sort_by_level(stale_parts_);
    std::atomic<bool> positive = true;
    const auto finish = [&](Index part, Threads threads, Workspace& work) {
        assemble(part, threads, work);
        for (const Index u : fronts_[part].unknown.entries()) work.place[u] = -1;
        if (eliminate(fronts_[part], threads, work)) stale_[part] = false;
        else positive = false;  // this front and those above it stay stale
    };
    for (std::size_t level = first_of_level_.size() - 1; level-- > 0 && positive;) {
        const std::span<const Index> parts = parts_of_level(level);
        divide(threads_, parts.size(), 1, [&](std::size_t first, std::size_t end) {
            Workspace& work = workspace();
            for (const Index part : parts.subspan(first, end - first)) {
                work.elements.clear();
                if (dissection_.parts[part].is_leaf()) elements_of(part, work.elements);
                find_unknowns(part, eliminated_in, work);
                if (is_large(part))
                    for (const Index u : fronts_[part].unknown.entries()) work.place[u] = -1;
                else finish(part, Threads::one, work);
            }
        });
        Workspace& work = workspaces_[0];
        work.elements.clear();
        for (const Index part : parts) {
            if (!is_large(part) || !positive) continue;
            const std::span<const Index> unknown = fronts_[part].unknown.entries();
            for (Index i = 0; i < fronts_[part].size(); ++i) work.place[unknown[i]] = i;
            finish(part, Threads::all, work);
        }
    }
    return positive;
}

/// In the order of their elimination, which that of both halves is, too.
void FrontalFactor::find_unknowns(Index part, const std::vector<Index>& eliminated_in, Workspace& work) {
    const auto key = [&](Index u) { return (std::int64_t(eliminated_in[u]) << 32) + u; };
    work.unknown.clear();
    if (const Dissection::Part& at = dissection_.parts[part]; !at.is_leaf())
        std::ranges::set_union(fronts_[at.child[0]].left(), fronts_[at.child[1]].left(),
                               std::back_inserter(work.unknown), {}, key, key);
    for (const Element& element : work.elements)
        for (const Index u : std::span(element.unknown).first(element.n_unknowns))
            if (u >= 0 && std::exchange(work.place[u], 0) < 0) work.unknown.push_back(u);
    if (!work.elements.empty()) std::ranges::sort(work.unknown, {}, key);
    Front& front = fronts_[part];
    front.unknown.resize(arena_, work.unknown.size());
    const std::span<Index> unknown = front.unknown.entries();
    std::ranges::copy(work.unknown, unknown.begin());
    const auto is_own = [&](Index u) { return eliminated_in[u] == part; };
    front.n_eliminated = static_cast<Index>(std::ranges::partition_point(unknown, is_own) - unknown.begin());
    for (Index i = 0; i < front.size(); ++i) work.place[unknown[i]] = i;
}

void FrontalFactor::assemble(Index part, Threads threads, Workspace& work) {
    Front& front = fronts_[part];
    front.L.resize(arena_, front.size() * std::size_t(front.n_eliminated) + front_padding);
    front.schur.resize(arena_, front.first_of_panel(front.n_left() + panel - 1) + front_padding);
    const bool has_halves = !dissection_.parts[part].is_leaf();
    for (int i = 0; has_halves && i < 2; ++i) {
        Half& half = work.half[i];
        half.front = &fronts_[dissection_.parts[part].child[i]];
        half.row.clear();
        half.column.assign(front.size(), -1);
        for (const Index u : half.front->left()) {
            half.column[work.place[u]] = static_cast<Index>(half.row.size());
            half.row.push_back(work.place[u]);
        }
    }
    divide(threads, front.size(), columns_at_once, [&](std::size_t first, std::size_t end) {
        for (std::size_t k = first; k < end; ++k) {  // with the rows above the diagonal that the kernel reads
            const std::size_t top = front.first_row(static_cast<Index>(k));
            double* column = front.column(static_cast<Index>(k));
            std::fill(column + std::max(top, k - std::min(k, front_padding)), column + front.size(), 0.0);
            for (int i = 0; has_halves && i < 2; ++i) {
                const Half& half = work.half[i];
                const Index j = half.column[k], n = half.front->n_left();
                if (j < 0) continue;
                const double* from = half.front->schur_column(j);
                for (Index r = j; r < n; ++r) column[half.row[r]] += from[r];
            }
        }
    });
    for (const Element& element : work.elements) {
        std::array<Index, std::tuple_size_v<decltype(element.unknown)>> place;
        for (int i = 0; i < element.n_unknowns; ++i)
            place[i] = element.unknown[i] < 0 ? -1 : work.place[element.unknown[i]];
        for (int j = 0; j < element.n_unknowns; ++j) {
            if (place[j] < 0) continue;
            double* column = front.column(place[j]);
            for (int i = 0; i < element.n_unknowns; ++i)
                if (place[i] >= place[j]) column[place[i]] += element.matrix(i, j);
        }
    }
}

/// Block by block of its columns, each of which changes all columns behind it. The first block takes the remainder, so
/// that the columns behind the others, and those of the Schur complement, start with a panel of packed rows.
bool FrontalFactor::eliminate(Front& front, Threads threads, Workspace& work) {
    const std::ptrdiff_t size = front.size(), n = front.n_eliminated;
    double* L = front.L.first();
    for (std::ptrdiff_t begin = 0, end; begin < n; begin = end) {
        end = begin == 0 && n % pivots_at_once > 0 ? n % pivots_at_once : begin + pivots_at_once;
        const std::ptrdiff_t done = threads == Threads::all ? end : size, n_pivots = end - begin;  // done: rows
        if (!kernel_.eliminate(L, size, begin, end, done)) return false;
        divide(threads, size - done, rows_at_once, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
            kernel_.eliminate_further_rows(L, size, begin, end, done + first, done + last);
        });
        work.packed.resize(arena_, n_pivots * (size - end + front_padding));
        double* packed = work.packed.first();
        divide(threads, size - end, rows_at_once, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
            kernel_.pack(L, size, begin, end, end + first, end + last, packed + n_pivots * first);
        });
        divide(threads, n - end, columns_at_once, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
            kernel_.subtract_products(packed, n_pivots, L + end * (size + 1), size, size - end, first, last);
        });
        divide(threads, size - n, panel, [&](std::ptrdiff_t first, std::ptrdiff_t last) {
            for (std::ptrdiff_t j = first; j < last; j += panel)
                kernel_.subtract_products(packed + n_pivots * (n - end + j), n_pivots,
                                          front.schur.first() + front.first_of_panel(j), size - n - j, size - n - j, 0,
                                          std::min<std::ptrdiff_t>(panel, last - j));
        });
    }
    return true;
}

double* FrontalFactor::load(const Front& front, const std::vector<double>& x) {
    double* local = workspace().local.data();
    const Index* unknown = front.unknown.first();
    for (Index i = 0; i < front.size(); ++i) local[i] = x[unknown[i]];
    return local;
}

void FrontalFactor::substitute_in_front(const Front& front, std::vector<double>& x) {
    if (front.n_eliminated == 0) return;
    double* local = load(front, x);
    kernel_.substitute(front.L.first(), front.size(), front.n_eliminated, local);
    for (Index i = 0; i < front.size(); ++i) x[front.unknown.first()[i]] = local[i];
}

void FrontalFactor::substitute_back_in_front(const Front& front, std::vector<double>& x) {
    if (front.n_eliminated == 0) return;
    double* local = load(front, x);
    kernel_.substitute_back(front.L.first(), front.size(), front.n_eliminated, local);
    for (Index i = 0; i < front.n_eliminated; ++i) x[front.unknown.first()[i]] = local[i];
}

void FrontalFactor::substitute(std::span<const Index> parts, std::vector<double>& x) {
    for (const Index part : parts) substitute_in_front(fronts_[part], x);
}

/// From the root down: the parts of a level read what those above have found.
void FrontalFactor::substitute_back(std::span<const Index> parts, std::vector<double>& x) {
    sort_by_level(parts);
    for (std::size_t level = 0; level + 1 < first_of_level_.size(); ++level) {
        const std::span<const Index> of_level = parts_of_level(level);
        divide(threads_, of_level.size(), 1 + of_level.size() / 32, [&](std::size_t first, std::size_t end) {
            for (const Index part : of_level.subspan(first, end - first)) substitute_back_in_front(fronts_[part], x);
        });
    }
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
