#include <Eigen/Eigenvalues>
#include <unsupported/Eigen/MatrixFunctions>

#include "tests/reference/matrix_functions.h"

namespace reference
{

std::vector<std::complex<double>> eigenvalues(const Eigen::MatrixXd &matrix)
{
    const Eigen::VectorXcd values = matrix.eigenvalues();
    return {values.data(), values.data() + values.size()};
}

double spectral_radius(const Eigen::MatrixXd &matrix)
{
    return matrix.eigenvalues().cwiseAbs().maxCoeff();
}

Eigen::MatrixXd exponential(const Eigen::MatrixXd &matrix)
{
    return matrix.exp();
}

} // namespace reference
