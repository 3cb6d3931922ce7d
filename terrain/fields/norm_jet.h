// Bounds of the first and second derivatives of a map y(x, h), carried through the steps that make the map: norms instead of numbers.
#pragma once

namespace hoodoo
{

/// Suprema of the norms of dy/dx, dy/dh, d2y/dx2, d2y/dxdh, d2y/dh2.
struct NormJet {
    double x = 0.0, h = 0.0, xx = 0.0, xh = 0.0, hh = 0.0;

    static NormJet identity() { return {1.0, 0.0, 0.0, 0.0, 0.0}; }
    NormJet operator+(const NormJet& o) const { return {x + o.x, h + o.h, xx + o.xx, xh + o.xh, hh + o.hh}; }
    NormJet operator*(double s) const { return {x * s, h * s, xx * s, xh * s, hh * s}; }

    /// Of v(y, t) with |Dv| <= gradient and |D2v| <= hessian, where t moves the pattern by `shift` for a unit of h.
    NormJet through(double gradient, double hessian, double shift) const
    {
        const double k = h + shift;
        return {gradient * x, gradient * k, hessian * x * x + gradient * xx, hessian * x * k + gradient * xh, hessian * k * k + gradient * hh};
    }

    /// Of (w h) y with |y| <= size, h <= step.
    NormJet times_step(double w, double step, double size) const
    {
        return {w * step * x, w * (size + step * h), w * step * xx, w * (x + step * xh), w * (2.0 * h + step * hh)};
    }

    /// Of R(y(x, h), h), this being y and `r` being R.
    NormJet then(const NormJet& r) const
    {
        return {r.x * x, r.x * h + r.h, r.xx * x * x + r.x * xx, r.xx * x * h + r.xh * x + r.x * xh, r.xx * h * h + 2.0 * r.xh * h + r.x * hh + r.hh};
    }
};

/// One step of RK4 of length `step` backwards or forwards along a flow of at most `speed`, with |Dv| <= gradient[i] at stage i.
inline NormJet rk4_jet(double step, double speed, const double (&gradient)[4], double hessian, double shift)
{
    const NormJet x = NormJet::identity();
    const NormJet k1 = x.through(gradient[0], hessian, shift);
    const NormJet k2 = (x + k1.times_step(0.5, step, speed)).through(gradient[1], hessian, shift);
    const NormJet k3 = (x + k2.times_step(0.5, step, speed)).through(gradient[2], hessian, shift);
    const NormJet k4 = (x + k3.times_step(1.0, step, speed)).through(gradient[3], hessian, shift);
    return x + (k1 + k2 * 2.0 + k3 * 2.0 + k4).times_step(1.0 / 6.0, step, 6.0 * speed);
}

}  // namespace hoodoo
