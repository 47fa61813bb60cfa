#pragma once
// Dense arithmetic of one front of the factor (frontal_factor.hpp), compiled once per instruction set
// (front_kernel_*.cpp) with the same bits from each. Tiles of eight rows and four columns stay in registers, so small
// fronts are as fast as large ones: over Eigen's products 1.2 to 2.3 times without AVX2 (0.7 at 320 unknowns), 2.2 to
// 4.2 times with it. These files include nothing with inline functions, like constant_strain.hpp.
#include <cstddef>

namespace knap {

/// A front of `size` unknowns, of which the first `n` are eliminated. L is size x n and the Schur complement
/// (size - n) x (size - n), both column by column; of both the lower half counts. The kernel also reads, and does not
/// use, what lies up to `front_padding` numbers behind either.
struct FrontKernel {
    /// Replaces columns `begin` to before `end` by those of L, in the rows from the diagonal to before `end_of_rows`;
    /// the products of the columns before them have been subtracted. False: not positive definite.
    bool (*eliminate)(double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end,
                      std::ptrdiff_t end_of_rows);
    /// The same columns in further rows. The entries do not depend on how rows and columns are divided. Several threads
    /// may each do a multiple of eight rows.
    void (*eliminate_further_rows)(double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end,
                                   std::ptrdiff_t first_row, std::ptrdiff_t end_of_rows);
    /// Rows of these columns in panels of eight rows, column by column: (end - begin) times the number of rows, rounded
    /// up to a multiple of eight. Products then read memory in succession.
    void (*pack)(const double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end,
                 std::ptrdiff_t first_row, std::ptrdiff_t end_of_rows, double* packed);
    /// Columns `begin` to before `end` of a matrix of `n_rows` rows, `stride` apart, minus the product of the rows of
    /// `n` packed columns, of which the first ones belong to the first row and column. Changes entries above the
    /// diagonal, which do not count, too. Several threads may each do a multiple of eight columns.
    void (*subtract_products)(const double* packed, std::ptrdiff_t n, double* columns, std::ptrdiff_t stride,
                              std::ptrdiff_t n_rows, std::ptrdiff_t begin, std::ptrdiff_t end);
    /// x of the eliminated unknowns <- A^-1 x in two parts: L^-1 x, which changes the others, too, and what lies up to
    /// `front_padding` numbers behind them, and L^-T x.
    void (*substitute)(const double* L, std::ptrdiff_t size, std::ptrdiff_t n, double* x);
    void (*substitute_back)(const double* L, std::ptrdiff_t size, std::ptrdiff_t n, double* x);
};
constexpr std::size_t front_padding = 8;

FrontKernel baseline_front_kernel();
FrontKernel avx2_front_kernel();

}  // namespace knap
