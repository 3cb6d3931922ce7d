// Value, gradient and smoothed gradient of a convolution field near one point from one walk over its columns (Peytavie2009, section 3.3).
//
// f is linear in the overlaps D_ij(z) of the columns with the kernel. Sums over j are kept for each i side by side, A_i = sum_j w_j D_ij, so that
// neighbouring columns are lanes of a vector and no sum is reordered between processors; then V = sum_i w_i A_i. The central differences along x and
// y see the same D_ij under shifted weights, those along z the overlaps of a shifted window under the same weights.
// Nearly every column has one run of matter inside the kernel: the first is kept in arrays, the few others in a list.

#include "terrain/stack/columns_around.h"

#include "terrain/stack/window.h"

#include <cmath>

namespace hoodoo
{
namespace
{

double overlap(double bottom, double top, double low, double high)
{
    return std::max(0.0, std::min(high, top) - std::max(low, bottom));
}

/// Derivative of the overlap by the height of the window, one-sided.
double change(double bottom, double top, double low, double high)
{
    return static_cast<double>((bottom <= high) & (high < top)) - static_cast<double>((bottom <= low) & (low < top));
}

}  // namespace

ColumnsAround::ColumnsAround(const ConvolutionField& field, const Vec3d& centre, double reach) : field_(field)
{
    const MaterialStack& stack = field.ground().stack();
    half_ = field.sigma() / stack.cell(), tall_ = field.sigma() / stack.unit();
    const double wide = half_ + reach / stack.cell(), z = (centre.z - stack.origin().z) / stack.unit(), high = tall_ + reach / stack.unit();
    // A guard of 1e-9 covers the rounding of points at the reach's end.
    low_ = z - high - 1e-9, high_ = z + high + 1e-9;
    for (int k = 0; k < 2; ++k) {
        const double u = confined((centre[k] - stack.origin()[k]) / stack.cell(), half_, stack.size()[k]);
        first_[k] = static_cast<int>(std::floor(u - wide - 1e-9));
        count_[k] = static_cast<int>(std::floor(u + wide + 1e-9)) - first_[k] + 1;
    }
    usable_ = count_.x <= most_columns && count_.y <= most_columns;
    if (usable_) read();
}

void ColumnsAround::read()
{
    stride_ = (count_.x + lanes - 1) / lanes * lanes;
    const Ground& ground = field_.ground();
    const Vec2i n = ground.stack().size();
    for (int j = 0; j < count_.y; ++j) {
        std::fill_n(bottom_.data() + j * stride_, stride_, low_);
        std::fill_n(top_.data() + j * stride_, stride_, low_);
        const int y = first_.y + j;
        if (ground.border() == Border::cut && (y < 0 || y >= n.y)) continue;
        for (int i = 0; i < count_.x; ++i) {
            const int x = first_.x + i;
            if (ground.border() == Border::cut && (x < 0 || x >= n.x)) continue;
            read_column(i, j, ground.stack().words(std::clamp(x, 0, n.x - 1), std::clamp(y, 0, n.y - 1)));
        }
    }
}

void ColumnsAround::read_column(int i, int j, std::span<const std::uint16_t> words)
{
    // Bounds of the run under way; it is kept when it ends.
    double bottom = field_.ground().floor(), top = bottom;
    int kept = 0;
    const auto keep = [&] {
        if (!(top > low_ && bottom < top)) return;
        if (kept++ == 0) {
            const auto k = static_cast<std::size_t>(j * stride_ + i);
            bottom_[k] = bottom, top_[k] = top;
        } else if (further_count_ < most_further) {
            further_[static_cast<std::size_t>(further_count_++)] = {i, j, bottom, top};
        } else {
            usable_ = false;
        }
    };
    if (field_.ground().contains(Material::bedrock)) top = 0.0;
    if (low_ < 0.0) seen_ = static_cast<MaterialSet>(seen_ | material_set({Material::bedrock}));
    double from = 0.0;
    for (const std::uint16_t word : words) {
        if (from > high_) break;
        const Material material = MaterialStack::material_of(word);
        const double to = MaterialStack::top_of(word);
        if (to > low_) seen_ = static_cast<MaterialSet>(seen_ | (1u << static_cast<unsigned>(material)));
        if (field_.ground().contains(material)) {
            if (top < from) {
                keep();
                bottom = from;
            }
            top = to;
        }
        from = to;
    }
    keep();
}

/// Widths of the columns under the kernel at `centre`, in cells; 0 for those it does not touch.
ColumnsAround::Row ColumnsAround::weights(double centre, int first, int count, int n) const
{
    const Window w = window(centre, half_, n);
    Row row;
    for (int k = 0; k < count; ++k) row[static_cast<std::size_t>(k)] = std::max(0.0, w.weight(first + k));
    return row;
}

/// Calls add(i, j, bottom, top) for every run, those of one row side by side.
template <class Add>
void ColumnsAround::visit(const Add& add) const
{
    for (int j = 0; j < count_.y; ++j) {
        const double* bottom = bottom_.data() + j * stride_;
        const double* top = top_.data() + j * stride_;
        for (int i = 0; i < stride_; ++i) add(i, j, bottom[i], top[i]);
    }
    for (int k = 0; k < further_count_; ++k) {
        const Further& run = further_[static_cast<std::size_t>(k)];
        add(run.i, run.j, run.bottom, run.top);
    }
}

double ColumnsAround::value(const Vec3d& p) const
{
    if (!usable_) return field_.value(p);
    const MaterialStack& stack = field_.ground().stack();
    const Vec3d& origin = stack.origin();
    const Row x = weights((p.x - origin.x) / stack.cell(), first_.x, count_.x, stack.size().x);
    const Row y = weights((p.y - origin.y) / stack.cell(), first_.y, count_.y, stack.size().y);
    const double z = (p.z - origin.z) / stack.unit(), low = z - tall_, high = z + tall_;
    Row sums;
    std::fill_n(sums.data(), stride_, 0.0);
    visit([&](int i, int j, double bottom, double top) { sums[i] += y[j] * overlap(bottom, top, low, high); });
    double volume = 0.0;
    for (int i = 0; i < count_.x; ++i) volume += x[i] * sums[i];
    return std::clamp(1.0 - volume / (4.0 * half_ * half_ * tall_), -1.0, 1.0);
}

ConvolutionField::Neighbourhood ColumnsAround::neighbourhood(const Vec3d& point, double width) const
{
    if (!usable_) return {field_.value(point), field_.gradient(point), field_.smoothed_gradient(point, width)};
    const MaterialStack& stack = field_.ground().stack();
    const double s = stack.cell(), unit = stack.unit();
    const Vec3d p = point - stack.origin();
    const auto along = [&](double centre, int axis) { return weights(centre / s, first_[axis], count_[axis], stack.size()[axis]); };
    const Row x = along(p.x, 0), x_below = along(p.x - width, 0), x_above = along(p.x + width, 0);
    const Row y = along(p.y, 1), y_below = along(p.y - width, 1), y_above = along(p.y + width, 1);
    // Columns in which the faces of the kernel at the centre lie.
    const Window wx = window(p.x / s, half_, stack.size().x), wy = window(p.y / s, half_, stack.size().y);
    Row front{}, shifted;
    front[wy.last - first_.y] += 1.0, front[wy.first - first_.y] -= 1.0;
    for (int j = 0; j < count_.y; ++j) shifted[j] = y_above[j] - y_below[j];

    const double z = p.z / unit, low = z - tall_, high = z + tall_, w = width / unit;
    Row sum, sum_shifted, sum_front, sum_rise, sum_change;
    for (Row* row : {&sum, &sum_shifted, &sum_front, &sum_rise, &sum_change}) std::fill_n(row->data(), stride_, 0.0);
    visit([&](int i, int j, double bottom, double top) {
        const double d = overlap(bottom, top, low, high);
        sum[i] += y[j] * d;
        sum_shifted[i] += shifted[j] * d;
        sum_front[i] += front[j] * d;
        sum_rise[i] += y[j] * (overlap(bottom, top, low + w, high + w) - overlap(bottom, top, low - w, high - w));
        sum_change[i] += y[j] * change(bottom, top, low, high);
    });
    double volume = 0.0;
    Vec3d difference(0.0), slope(sum[wx.last - first_.x] - sum[wx.first - first_.x], 0.0, 0.0);
    for (int i = 0; i < count_.x; ++i) {
        volume += x[i] * sum[i];
        difference += Vec3d((x_above[i] - x_below[i]) * sum[i], x[i] * sum_shifted[i], x[i] * sum_rise[i]);
        slope += Vec3d(0.0, x[i] * sum_front[i], x[i] * sum_change[i]);
    }
    const double scale = -1.0 / (4.0 * half_ * half_ * tall_);
    ConvolutionField::Neighbourhood n;
    n.value = std::clamp(1.0 + volume * scale, -1.0, 1.0);
    n.gradient = Vec3d(slope.x / s, slope.y / s, slope.z / unit) * scale;
    n.smoothed = difference * (scale / (2.0 * width));
    if (!(n.smoothed.length() >= 1e-3 / field_.sigma())) n.smoothed = field_.towards_nearest_interface(point);
    return n;
}

ConvolutionField::Neighbourhood ConvolutionField::neighbourhood(const Vec3d& p, double width) const
{
    return ColumnsAround(*this, p, width).neighbourhood(p, width);
}

}  // namespace hoodoo
