/* Functions of a matrix whose templates compile slowly: compiled once, for matrices of any size. */
#pragma once

#include <complex>
#include <vector>

#include <Eigen/Core>

namespace reference
{

/** The eigenvalues of a square matrix, in no order. */
std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd &matrix);

/** The largest magnitude of its eigenvalues. */
double spectral_radius(const Eigen::MatrixXd &matrix);

/** e to the power of a square matrix. */
Eigen::MatrixXd exponential(const Eigen::MatrixXd &matrix);

} // namespace reference
