// The columns of a convolution field around one point, read once and asked many times.
#pragma once

#include "terrain/stack/convolution.h"

#include <array>

namespace hoodoo
{

/// A copy of the runs of matter that the kernel can touch from anywhere within `reach` of a point, along each axis. It answers for such points what
/// the field would, up to rounding (1e-12), in a fraction of the time. Kernels that are too wide, or columns with too many runs, are passed on to the
/// field itself, which must outlive this.
class ColumnsAround
{
public:
    /// `reach` in metres, >= 0.
    ColumnsAround(const ConvolutionField& field, const Vec3d& centre, double reach);

    /// `p` within `reach` of the centre along each axis.
    double value(const Vec3d& p) const;

    /// `p` within reach - width of the centre along each axis; `width` in metres, > 0.
    ConvolutionField::Neighbourhood neighbourhood(const Vec3d& p, double width) const;

    /// All materials of the columns as far as they lie within the kernel's and the reach's heights, `reach` and more around the centre; every
    /// material if the columns are too many. A superset of what any point within reach can see.
    MaterialSet materials() const { return usable_ ? seen_ : static_cast<MaterialSet>(~0u); }

private:
    static constexpr int most_columns = 40;  ///< along an axis
    static constexpr int most_further = 96;  ///< runs beyond the first of each column
    static constexpr int lanes = 4;

    /// A run that is not the first of its column; i and j count from the first columns.
    struct Further {
        int i, j;
        double bottom, top;
    };
    using Row = std::array<double, most_columns>;

    void read();
    void read_column(int i, int j, std::span<const std::uint16_t> words);
    Row weights(double centre, int first, int count, int n) const;
    template <class Add>
    void visit(const Add& add) const;

    const ConvolutionField& field_;
    double half_, tall_;         ///< sigma in cells and in units
    double low_, high_;          ///< heights that are kept, units
    Vec2i first_{0}, count_{0};  ///< of columns
    int stride_ = 0;             ///< count_.x, rounded up to whole lanes
    MaterialSet seen_ = 0;
    bool usable_ = false;  ///< false: the field answers
    int further_count_ = 0;
    std::array<double, most_columns * most_columns> bottom_, top_;  ///< of the first run of each column; equal where there is none
    std::array<Further, most_further> further_;
};

}  // namespace hoodoo
