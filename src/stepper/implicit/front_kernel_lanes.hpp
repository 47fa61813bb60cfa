#pragma once
// See front_kernel.hpp. Included by one file per instruction set, of which nobody else can name the kernels.
#include "stepper/implicit/front_kernel.hpp"

namespace knap {
namespace {

constexpr int n_rows = 8, n_columns = 4;  // of a tile; every instruction set adds in the same order

template <int lanes>
struct Register;
template <>
struct Register<2> {
    using type = double __attribute__((vector_size(16)));
    using anywhere = double __attribute__((vector_size(16), aligned(8), may_alias));
};
template <>
struct Register<4> {
    using type = double __attribute__((vector_size(32)));
    using anywhere = double __attribute__((vector_size(32), aligned(8), may_alias));
};

/// Eight neighbours in a column, in registers of `lanes` numbers.
template <int lanes>
struct Rows {
    static constexpr int n = n_rows / lanes;
    using Anywhere = typename Register<lanes>::anywhere;
    typename Register<lanes>::type part[n];

    [[gnu::always_inline]] void load(const double* from) {
#pragma GCC unroll 4
        for (int i = 0; i < n; ++i) part[i] = *reinterpret_cast<const Anywhere*>(from + i * lanes);
    }
    [[gnu::always_inline]] void store(double* to) const {
#pragma GCC unroll 4
        for (int i = 0; i < n; ++i) *reinterpret_cast<Anywhere*>(to + i * lanes) = part[i];
    }
    [[gnu::always_inline]] void clear() {
#pragma GCC unroll 4
        for (int i = 0; i < n; ++i) part[i] = typename Register<lanes>::type{};
    }
    [[gnu::always_inline]] void subtract(const Rows& a, double b) {
#pragma GCC unroll 4
        for (int i = 0; i < n; ++i) part[i] -= a.part[i] * b;
    }
    [[gnu::always_inline]] void add(const Rows& a, const Rows& b) {
#pragma GCC unroll 4
        for (int i = 0; i < n; ++i) part[i] += a.part[i] * b.part[i];
    }
    [[gnu::always_inline]] void scale(double b) {
#pragma GCC unroll 4
        for (int i = 0; i < n; ++i) part[i] *= b;
    }
};

template <int lanes, int width>
struct Tile {
    Rows<lanes> column[width];

    [[gnu::always_inline]] void load(const double* from, std::ptrdiff_t stride) {
#pragma GCC unroll 4
        for (int c = 0; c < width; ++c) column[c].load(from + c * stride);
    }
    [[gnu::always_inline]] void store(double* to, std::ptrdiff_t stride, std::ptrdiff_t n) const {
#pragma GCC unroll 4
        for (int c = 0; c < width; ++c) {
            if (n == n_rows) {
                column[c].store(to + c * stride);
                continue;
            }
            double some[n_rows];
            column[c].store(some);
            for (std::ptrdiff_t i = 0; i < n; ++i) to[c * stride + i] = some[i];
        }
    }
    /// Minus the product of `n` columns, `stride` apart, from `row` on, and of those from `row_of_column` on.
    [[gnu::always_inline]] void subtract_product(const double* row, const double* row_of_column, std::ptrdiff_t stride,
                                                 std::ptrdiff_t n) {
        for (std::ptrdiff_t k = 0; k < n; ++k, row += stride, row_of_column += stride) {
            Rows<lanes> a;
            a.load(row);
#pragma GCC unroll 4
            for (int c = 0; c < width; ++c) column[c].subtract(a, row_of_column[c]);
        }
    }
};

/// The diagonal of `width` columns of L.
template <int width>
struct Pivot {
    double entry[width][width] = {}, inverse[width] = {};  // column, row
};

/// Rows from `begin` to before `end` of columns j to j + width of L, from those since column `first` and their pivot.
template <int lanes, int width>
void eliminate_rows(double* L, std::ptrdiff_t size, std::ptrdiff_t first, std::ptrdiff_t j, const Pivot<width>& pivot,
                    std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t i = begin; i < end; i += n_rows) {
        Tile<lanes, width> tile;
        tile.load(L + i + size * j, size);
        tile.subtract_product(L + i + size * first, L + j + size * first, size, j - first);
#pragma GCC unroll 4
        for (int c = 0; c < width; ++c) {
#pragma GCC unroll 4
            for (int b = 0; b < c; ++b) tile.column[c].subtract(tile.column[b], pivot.entry[b][c]);
            tile.column[c].scale(pivot.inverse[c]);
        }
        tile.store(L + i + size * j, size, end - i < n_rows ? end - i : n_rows);
    }
}

/// Columns j to j + width of L in the rows to before `end`, from those since column `first`.
template <int lanes, int width>
bool eliminate_columns(double* L, std::ptrdiff_t size, std::ptrdiff_t first, std::ptrdiff_t j, std::ptrdiff_t end) {
    Tile<lanes, width> tile;
    tile.load(L + j + size * j, size);
    tile.subtract_product(L + j + size * first, L + j + size * first, size, j - first);
    double top[width][n_rows];
    tile.store(&top[0][0], n_rows, n_rows);
    Pivot<width> pivot;
    for (int c = 0; c < width; ++c) {
        for (int b = 0; b < c; ++b)
            for (int r = c; r < width; ++r) top[c][r] -= top[b][r] * top[b][c];
        if (!(top[c][c] > 0) || top[c][c] == __builtin_inf()) return false;
        const double root = __builtin_sqrt(top[c][c]);
        pivot.inverse[c] = 1 / root;
        top[c][c] = root;
        for (int r = c + 1; r < width; ++r) top[c][r] *= pivot.inverse[c];
        for (int r = c; r < width; ++r) pivot.entry[c][r] = top[c][r];
    }
    for (int c = 0; c < width; ++c) {
        for (int b = 0; b < c; ++b)
            for (int r = width; r < n_rows; ++r) top[c][r] -= top[b][r] * pivot.entry[b][c];
        for (int r = width; r < n_rows; ++r) top[c][r] *= pivot.inverse[c];
    }
    tile.load(&top[0][0], n_rows);
    tile.store(L + j + size * j, size, end - j < n_rows ? end - j : n_rows);
    eliminate_rows<lanes, width>(L, size, first, j, pivot, j + n_rows, end);
    return true;
}

/// The same columns in further rows.
template <int lanes, int width>
void continue_columns(double* L, std::ptrdiff_t size, std::ptrdiff_t first, std::ptrdiff_t j, std::ptrdiff_t begin,
                      std::ptrdiff_t end) {
    Pivot<width> pivot;
    for (int c = 0; c < width; ++c) {
        for (int r = c; r < width; ++r) pivot.entry[c][r] = L[j + r + size * (j + c)];
        pivot.inverse[c] = 1 / pivot.entry[c][c];
    }
    eliminate_rows<lanes, width>(L, size, first, j, pivot, begin, end);
}

template <int lanes>
void pack(const double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end, std::ptrdiff_t first_row,
          std::ptrdiff_t end_of_rows, double* packed) {
    for (std::ptrdiff_t i = first_row; i < end_of_rows; i += n_rows)
        for (std::ptrdiff_t k = begin; k < end; ++k, packed += n_rows) {
            Rows<lanes> rows;
            rows.load(L + i + size * k);
            rows.store(packed);
        }
}

/// Columns j to j + width, which are of one panel, in the rows from this panel on.
template <int lanes, int width>
void subtract_products_from(const double* packed, std::ptrdiff_t n, double* columns, std::ptrdiff_t stride,
                            std::ptrdiff_t end_of_rows, std::ptrdiff_t j) {
    const std::ptrdiff_t place = j % n_rows, begin = j - place;
    for (std::ptrdiff_t i = begin; i < end_of_rows; i += n_rows) {
        double* at = columns + i + stride * j;
        Tile<lanes, width> tile;
        tile.load(at, stride);
        tile.subtract_product(packed + n * i, packed + n * begin + place, n_rows, n);
        tile.store(at, stride, end_of_rows - i < n_rows ? end_of_rows - i : n_rows);
    }
}

template <int lanes>
bool eliminate(double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end, std::ptrdiff_t end_of_rows) {
    std::ptrdiff_t j = begin;
    for (; j + n_columns <= end; j += n_columns)
        if (!eliminate_columns<lanes, n_columns>(L, size, begin, j, end_of_rows)) return false;
    for (; j + 2 <= end; j += 2)
        if (!eliminate_columns<lanes, 2>(L, size, begin, j, end_of_rows)) return false;
    for (; j < end; ++j)
        if (!eliminate_columns<lanes, 1>(L, size, begin, j, end_of_rows)) return false;
    return true;
}

template <int lanes>
void eliminate_further_rows(double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end,
                            std::ptrdiff_t first_row, std::ptrdiff_t end_of_rows) {
    std::ptrdiff_t j = begin;
    for (; j + n_columns <= end; j += n_columns)
        continue_columns<lanes, n_columns>(L, size, begin, j, first_row, end_of_rows);
    for (; j + 2 <= end; j += 2) continue_columns<lanes, 2>(L, size, begin, j, first_row, end_of_rows);
    for (; j < end; ++j) continue_columns<lanes, 1>(L, size, begin, j, first_row, end_of_rows);
}

template <int lanes>
void subtract_products(const double* packed, std::ptrdiff_t n, double* columns, std::ptrdiff_t stride,
                       std::ptrdiff_t end_of_rows, std::ptrdiff_t begin, std::ptrdiff_t end) {
    std::ptrdiff_t j = begin;
    for (; j + n_columns <= end; j += n_columns)
        subtract_products_from<lanes, n_columns>(packed, n, columns, stride, end_of_rows, j);
    for (; j + 2 <= end; j += 2) subtract_products_from<lanes, 2>(packed, n, columns, stride, end_of_rows, j);
    for (; j < end; ++j) subtract_products_from<lanes, 1>(packed, n, columns, stride, end_of_rows, j);
}

/// x <- L^-1 x for `width` unknowns from j on, and minus L_B times them below.
template <int lanes, int width>
void substitute_columns(const double* L, std::ptrdiff_t size, std::ptrdiff_t j, double* x) {
    const double* column[width];
    for (int c = 0; c < width; ++c) column[c] = L + size * (j + c);
    for (int c = 0; c < width; ++c) {
        for (int b = 0; b < c; ++b) x[j + c] -= column[b][j + c] * x[j + b];
        x[j + c] /= column[c][j + c];
    }
    double known[width];
    for (int c = 0; c < width; ++c) known[c] = x[j + c];
    for (std::ptrdiff_t i = j + width; i < size; i += n_rows) {  // also behind the end, where nothing counts
        Rows<lanes> sum, a;
        sum.load(x + i);
#pragma GCC unroll 4
        for (int c = 0; c < width; ++c) a.load(column[c] + i), sum.subtract(a, known[c]);
        sum.store(x + i);
    }
}

/// x <- L^-T x for them, from the known ones below.
template <int lanes, int width>
void substitute_back_columns(const double* L, std::ptrdiff_t size, std::ptrdiff_t j, double* x) {
    const double* column[width];
    Rows<lanes> sums[width];
#pragma GCC unroll 4
    for (int c = 0; c < width; ++c) column[c] = L + size * (j + c), sums[c].clear();
    std::ptrdiff_t i = j + width;
    for (; i + n_rows <= size; i += n_rows) {
        Rows<lanes> a, b;
        b.load(x + i);
#pragma GCC unroll 4
        for (int c = 0; c < width; ++c) a.load(column[c] + i), sums[c].add(a, b);
    }
    double some[width][n_rows], known[width];
#pragma GCC unroll 4
    for (int c = 0; c < width; ++c) {
        sums[c].store(some[c]);
        known[c] = ((some[c][0] + some[c][4]) + (some[c][2] + some[c][6])) +
                   ((some[c][1] + some[c][5]) + (some[c][3] + some[c][7]));
    }
    for (; i < size; ++i)
        for (int c = 0; c < width; ++c) known[c] += column[c][i] * x[i];
    for (int c = width - 1; c >= 0; --c) {
        for (int b = c + 1; b < width; ++b) known[c] += column[c][j + b] * x[j + b];
        x[j + c] = (x[j + c] - known[c]) / column[c][j + c];
    }
}

template <int lanes>
void substitute(const double* L, std::ptrdiff_t size, std::ptrdiff_t n, double* x) {
    std::ptrdiff_t j = 0;
    for (; j + n_columns <= n; j += n_columns) substitute_columns<lanes, n_columns>(L, size, j, x);
    for (; j < n; ++j) substitute_columns<lanes, 1>(L, size, j, x);
}

template <int lanes>
void substitute_back(const double* L, std::ptrdiff_t size, std::ptrdiff_t n, double* x) {
    std::ptrdiff_t j = n;
    for (; j % n_columns != 0; --j) substitute_back_columns<lanes, 1>(L, size, j - 1, x);
    for (; j > 0; j -= n_columns) substitute_back_columns<lanes, n_columns>(L, size, j - n_columns, x);
}

template <int lanes>
FrontKernel front_kernel_of() {
    return {eliminate<lanes>,  eliminate_further_rows<lanes>, pack<lanes>, subtract_products<lanes>,
            substitute<lanes>, substitute_back<lanes>};
}

}  // namespace
}  // namespace knap
