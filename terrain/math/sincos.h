// Sine and cosine together, small enough to be inlined into loops over waves: the library's own take two calls and most of a wave's time.
#pragma once

#include <cmath>

namespace hoodoo
{

struct SinCos {
    double sine, cosine;
};

/// Of an angle in radians, within 3e-16 up to 1e4 and within 1e-15 up to 1e5 (the quarter turns are taken off in two parts); beyond as exact as the
/// angle's own last place. Taylor's series up to the power 17 and 16 on [-pi/4, pi/4]: the rest is below 1e-17.
inline SinCos sin_cos(double angle)
{
    constexpr double quarter_high = 1.5707963267341256, quarter_low = 6.0771005065061922e-11;  // their sum is pi / 2; the first has 33 bits
    const double turns = std::nearbyint(angle * 0.63661977236758134), r = (angle - turns * quarter_high) - turns * quarter_low, q = r * r;
    // Coefficients are the reciprocals of factorials.
    double s = 2.8114572543455206e-15;  // 1 / 17!
    s = s * q - 7.6471637318198164e-13;
    s = s * q + 1.6059043836821613e-10;
    s = s * q - 2.505210838544172e-8;
    s = s * q + 2.7557319223985893e-6;
    s = s * q - 1.9841269841269841e-4;
    s = s * q + 8.3333333333333332e-3;
    s = s * q - 1.6666666666666666e-1;
    double c = 4.7794773323873853e-14;  // 1 / 16!
    c = c * q - 1.1470745597729725e-11;
    c = c * q + 2.08767569878681e-9;
    c = c * q - 2.7557319223985888e-7;
    c = c * q + 2.4801587301587302e-5;
    c = c * q - 1.3888888888888889e-3;
    c = c * q + 4.1666666666666664e-2;
    c = c * q - 0.5;
    s = r + r * q * s;
    c = 1.0 + q * c;
    const auto quadrant = static_cast<long long>(turns) & 3;
    const double a = quadrant & 1 ? c : s, b = quadrant & 1 ? s : c;
    return {quadrant & 2 ? -a : a, quadrant == 1 || quadrant == 2 ? -b : b};
}

}  // namespace hoodoo
