// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>

namespace swath::core {

namespace math = boost::math;

double normal_quantile(double p) { return math::quantile(math::normal(), p); }

double chi_square_quantile(double p, double f) { return math::quantile(math::chi_squared(f), p); }

double chi_square_limit(double q, double f) { return math::quantile(math::complement(math::chi_squared(f), q)); }

}  // namespace swath::core
