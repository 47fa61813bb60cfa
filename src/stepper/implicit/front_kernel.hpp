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
    /// Replaces columns `begin` to before `end` by those of L, in the rows from the diagonal to before `end_of_rows`,
    /// where the columns before them are complete up to there. False: not positive definite.
    bool (*eliminate)(double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end,
                      std::ptrdiff_t end_of_rows);
    /// The same columns in further rows. The entries do not depend on how rows and columns are divided. Several threads
    /// may each do a multiple of eight rows.
    void (*eliminate_further_rows)(double* L, std::ptrdiff_t size, std::ptrdiff_t begin, std::ptrdiff_t end,
                                   std::ptrdiff_t first_row, std::ptrdiff_t end_of_rows);
    /// Columns `begin` to before `end` of the Schur complement, which becomes that of the whole L. Several threads may
    /// each do a multiple of eight columns.
    void (*update_schur)(const double* L, double* schur, std::ptrdiff_t size, std::ptrdiff_t n, std::ptrdiff_t begin,
                         std::ptrdiff_t end);
    /// x of the eliminated unknowns <- A^-1 x in two parts: L^-1 x, which changes the others, too, and L^-T x.
    void (*substitute)(const double* L, std::ptrdiff_t size, std::ptrdiff_t n, double* x);
    void (*substitute_back)(const double* L, std::ptrdiff_t size, std::ptrdiff_t n, double* x);
};
constexpr std::size_t front_padding = 8;

FrontKernel baseline_front_kernel();
FrontKernel avx2_front_kernel();

}  // namespace knap
