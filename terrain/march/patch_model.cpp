// Rays that miss a patch, or cross it plainly, should not cost an evaluation of its field: a quadratic with a proved error answers first.
//
// Fit: least squares over the nodes of a regular grid, on which 1, u, v, w, uv, uw, vw and u^2 - mean(u^2), ... are orthogonal.
// Proof of the error, of r = F - Q over the box: at the nodes r is known. Between them
//   (i)  r differs from what its values at the corners of a part interpolate by at most sum_k |r_kk| h_k^2 / 8 (linear interpolation, one axis after
//        the other; interpolation between smaller numbers makes no larger ones), and |r_kk| <= |F_kk| + |Q_kk|;
//   (ii) from the nearest node it strays by at most sum_k max |F_k - Q_k| h_k / 2, which holds where the gradient jumps too.
// The smaller counts, plus the rounding of both. The quadratic's own coefficients are rounded to single precision first, so that is in the nodes' r.
#include "terrain/march/patch_model.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// Of values computed twice, by the size of the numbers they are made of.
constexpr double kRounding = 1e-12;

float above(double x)
{
    return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

}  // namespace

NodeGrid::NodeGrid(const MarchedField& field, const Box3d& where, int count) : box(where), parts(count)
{
    const int side = parts + 1, all = side * side * side;
    const Vec3d step = box.size() / parts;
    values.resize(static_cast<std::size_t>(all));
    for (int first = 0; first < all; first += MarchedField::batch) {
        Vec3d p[MarchedField::batch];
        double v[MarchedField::batch];
        for (int i = 0; i < MarchedField::batch; ++i) {
            const int k = std::min(first + i, all - 1);
            p[i] = box.min + Vec3d(step.x * (k % side), step.y * (k / side % side), step.z * (k / (side * side)));
        }
        field.values(p, std::min(MarchedField::batch, all - first), 0.0, v);
        std::copy_n(v, std::min(MarchedField::batch, all - first), values.begin() + first);
    }
}

double NodeGrid::interpolation_error(const Vec3d& second) const
{
    const Vec3d h = box.size() / parts;
    return (second.x * h.x * h.x + second.y * h.y * h.y + second.z * h.z * h.z) / 8.0;
}

Box3d parts_with_zero(const NodeGrid& grid, const LocalField& known, double flat)
{
    // Or, where the gradient jumps: from the nearest corner the field strays by no more than its slopes allow.
    const Vec3d part = grid.box.size() / grid.parts;
    double stray = 0.0;
    for (int k = 0; k < 3; ++k) stray += 0.5 * known.gradient[static_cast<std::size_t>(k)].magnitude() * part[k];
    const double error = flat + std::min(stray, grid.interpolation_error({known.curvature, known.curvature, known.upright}));
    Box3d left;
    for (int z = 0; z < grid.parts; ++z) {
        for (int y = 0; y < grid.parts; ++y) {
            for (int x = 0; x < grid.parts; ++x) {
                double low = kInfinity, high = -kInfinity;
                for (int c = 0; c < 8; ++c) {
                    const double v = grid.at(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
                    low = std::min(low, v), high = std::max(high, v);
                }
                if (low > error || high < -error) continue;
                left.extendBy(grid.box.min + Vec3d(part.x * x, part.y * y, part.z * z));
                left.extendBy(grid.box.min + Vec3d(part.x * (x + 1), part.y * (y + 1), part.z * (z + 1)));
            }
        }
    }
    return left;
}

double PatchModel::at(const Vec3d& u) const
{
    const double x = u.x, y = u.y, z = u.z;
    return value + x * (gradient[0] + second[0] * x + second[3] * y + second[4] * z) + y * (gradient[1] + second[1] * y + second[5] * z) +
           z * (gradient[2] + second[2] * z);
}

ModelAlong PatchModel::along(const Vec3d& u, const Vec3d& d) const
{
    // The gradient at u, and half the second derivative along d.
    const Vec3d slope(gradient[0] + 2.0 * second[0] * u.x + second[3] * u.y + second[4] * u.z,
                      gradient[1] + second[3] * u.x + 2.0 * second[1] * u.y + second[5] * u.z,
                      gradient[2] + second[4] * u.x + second[5] * u.y + 2.0 * second[2] * u.z);
    return {at(u), slope.dot(d),
            d.x * (second[0] * d.x + second[3] * d.y + second[4] * d.z) + d.y * (second[1] * d.y + second[5] * d.z) + second[2] * d.z * d.z};
}

PatchModel fit_model(const NodeGrid& grid, const LocalField& known, double rounding)
{
    const int side = grid.parts + 1;
    const Vec3d half = grid.box.size() * 0.5;
    // Sums over one axis of the nodes u in [-1, 1], of u^2, and of the square of u^2 less its mean.
    double squares = 0.0, spreads = 0.0;
    const auto place = [&](int i) { return 2.0 * i / grid.parts - 1.0; };
    for (int i = 0; i < side; ++i) squares += place(i) * place(i);
    const double mean = squares / side;
    for (int i = 0; i < side; ++i) spreads += (place(i) * place(i) - mean) * (place(i) * place(i) - mean);

    double constant = 0.0, linear[3] = {}, own[3] = {}, pairs[3] = {};  // pairs: xy, xz, yz
    for (int z = 0; z < side; ++z) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const double f = grid.at(x, y, z), u[3] = {place(x), place(y), place(z)};
                constant += f;
                for (int k = 0; k < 3; ++k) linear[k] += f * u[k], own[k] += f * (u[k] * u[k] - mean);
                pairs[0] += f * u[0] * u[1], pairs[1] += f * u[0] * u[2], pairs[2] += f * u[1] * u[2];
            }
        }
    }
    const double plane = static_cast<double>(side) * side;
    PatchModel model;
    double value = constant / (plane * side);
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double h = std::max(half[k], 1e-300), c = own[k] / (plane * spreads);
        value -= c * mean;
        model.gradient[i] = static_cast<float>(linear[k] / (plane * squares) / h);
        model.second[i] = static_cast<float>(c / (h * h));
    }
    model.value = static_cast<float>(value);
    const int a[3] = {0, 0, 1}, b[3] = {1, 2, 2};
    for (int k = 0; k < 3; ++k)
        model.second[static_cast<std::size_t>(3 + k)] =
            static_cast<float>(pairs[k] / (squares * squares * side) / (std::max(half[a[k]], 1e-300) * std::max(half[b[k]], 1e-300)));

    double worst = 0.0, largest = 0.0;
    for (int z = 0; z < side; ++z) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const double f = grid.at(x, y, z);
                worst = std::max(worst, std::abs(f - model.at(Vec3d(half.x * place(x), half.y * place(y), half.z * place(z)))));
                largest = std::max(largest, std::abs(f));
            }
        }
    }
    const Vec3d own_second(2.0 * std::abs(model.second[0]), 2.0 * std::abs(model.second[1]), 2.0 * std::abs(model.second[2]));
    const double smooth = grid.interpolation_error(Vec3d(known.curvature, known.curvature, known.upright) + own_second);
    // (ii): the quadratic's gradient over the box is that at its middle, and what its second derivatives add.
    double strays = 0.0;
    const std::size_t beside[3][2] = {{3, 4}, {3, 5}, {4, 5}};
    const int other[3][2] = {{1, 2}, {0, 2}, {0, 1}};
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double turn = own_second[k] * half[k] + std::abs(model.second[beside[k][0]]) * half[other[k][0]] +
                            std::abs(model.second[beside[k][1]]) * half[other[k][1]];
        const Interval g = known.gradient[i];
        strays +=
            std::max(std::abs(g.lo - model.gradient[i]), std::abs(g.hi - model.gradient[i])) * half[k] / grid.parts + turn * half[k] / grid.parts;
    }
    model.error = above((worst + std::min(smooth, strays)) * (1.0 + 1e-9) + kRounding * (1.0 + largest) + rounding);
    return model;
}

int signed_pieces(const ModelAlong& model, double error, double length, SignedPiece (&pieces)[5])
{
    // Where the quadratic meets +error and -error: at most four places. A margin makes up for their rounding.
    const double band = error * (1.0 + 1e-6) + 1e-14 * (std::abs(model.a) + std::abs(model.b) * length + std::abs(model.c) * length * length);
    // Mostly it stays on one side of the band: then its extremes, at the ends or where it turns, say so without a root.
    const double first = model.a, last = model.at(length), turn = -0.5 * model.b, way = model.c * length;
    const bool turns = std::abs(turn) < std::abs(way) && (turn > 0.0) == (way > 0.0);
    const double middle = turns ? model.a + 0.5 * model.b * turn / model.c : first;
    for (const int sign : {1, -1}) {
        if (sign * first > band && sign * last > band && sign * middle > band) {
            pieces[0] = {0.0, length, sign};
            return 1;
        }
    }
    double cut[6] = {0.0};
    int cuts = 1;
    const auto add = [&](double root) {
        if (!(root > 0.0 && root < length)) return;
        int k = cuts++;
        for (; k > 1 && cut[k - 1] > root; --k) cut[k] = cut[k - 1];
        cut[k] = root;
    };
    for (const double level : {band, -band}) {
        const double a = model.a - level, inside = model.b * model.b - 4.0 * model.c * a;
        if (!(inside >= 0.0)) continue;
        // The two roots without cancellation.
        const double q = -0.5 * (model.b + std::copysign(std::sqrt(inside), model.b));
        add(q / model.c);
        add(a / q);
    }
    cut[cuts] = length;
    int count = 0;
    for (int i = 0; i < cuts; ++i) {
        const double f = model.at(0.5 * (cut[i] + cut[i + 1]));
        const int sign = f > band ? 1 : f < -band ? -1 : 0;
        if (count > 0 && pieces[count - 1].sign == sign)
            pieces[count - 1].to = cut[i + 1];
        else
            pieces[count++] = {cut[i], cut[i + 1], sign};
    }
    return count;
}

}  // namespace hoodoo
