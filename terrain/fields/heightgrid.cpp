// Sampled heights: blocks of nodes, a pyramid of what is known of them, and the two triangles of each cell as a height.
// GalinCourse, "Elevation maps". With u, v in [0, 1] within a cell the height is h00 + (h10 - h00) u + (h01 - h00) v where u + v <= 1, else
// h11 + (h01 - h11)(1 - u) + (h10 - h11)(1 - v): the printed code's formulas; its indices are mended (samples are nodes, so there are nx - 1 cells;
// the fraction stays in units of a cell). The pyramid is Tevs2008's, with the steepest slope beside the extremes.
// A sum over heights never leaves the samples' own type: an image of 16 bits costs 2 bytes a sample, and 13% for the borders that blocks repeat.
#include "terrain/fields/heightgrid.h"

#include "terrain/error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

namespace hoodoo
{

namespace
{

GridSummary merged(const GridSummary& a, const GridSummary& b)
{
    return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), std::max(a.slope, b.slope)};
}

constexpr GridSummary kNothing{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), 0.0f};

}  // namespace

HeightGrid::HeightGrid(const GridFrame& frame, int columns, int rows, SampleType type)
    : frame_(frame),
      per_metre_(1.0 / frame.cell.x, 1.0 / frame.cell.y, 1.0 / frame.scale),
      columns_(columns),
      rows_(rows),
      across_((columns - 2) / kBlock + 1),
      up_((rows - 2) / kBlock + 1)
{
    if (columns < 2 || rows < 2) throw Error(ErrorKind::internal, "a grid of heights has at least 2 x 2 nodes");
    const double nodes = static_cast<double>(across_) * up_ * kNodes;
    if (nodes > 0x1p31) throw Error(ErrorKind::memory, fmt::format("a grid of {} x {} heights is too large: at most 2^31 samples", columns, rows));
    const auto count = static_cast<std::size_t>(nodes);
    switch (type) {
        case SampleType::u8:
            samples_.emplace<0>(count);
            break;
        case SampleType::u16:
            samples_.emplace<1>(count);
            break;
        case SampleType::i16:
            samples_.emplace<2>(count);
            break;
        case SampleType::f32:
            samples_.emplace<3>(count);
            break;
    }
}

std::size_t HeightGrid::index(int column, int row) const
{
    // The last node of a grid lies on the border of the last block.
    const int bi = std::min(column / kBlock, across_ - 1), bj = std::min(row / kBlock, up_ - 1);
    const auto block = static_cast<std::size_t>(bj) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(bi);
    return block * kNodes + static_cast<std::size_t>((row - bj * kBlock) * kStride + column - bi * kBlock);
}

double HeightGrid::sample(int column, int row) const
{
    return std::visit([&](const auto& samples) { return static_cast<double>(samples[index(column, row)]); }, samples_);
}

void HeightGrid::fill(int column, int row, int width, int height, const void* data, std::ptrdiff_t row_step)
{
    std::visit(
        [&](auto& samples) {
            using T = typename std::decay_t<decltype(samples)>::value_type;
            for (int y = 0; y < height; ++y) {
                const int j = row_step < 0 ? row - y : row + y;
                if (j < 0 || j >= rows_) continue;
                const auto* line = reinterpret_cast<const T*>(static_cast<const char*>(data) + std::abs(row_step) * y);
                // Every block that has nodes of this row, twice at a border.
                for (int bj = std::max(0, (j - 1) / kBlock); bj <= std::min(j / kBlock, up_ - 1); ++bj) {
                    const int first = std::max(column, 0), last = std::min(column + width, columns_) - 1;
                    for (int bi = std::max(0, (first - 1) / kBlock); bi <= std::min(last / kBlock, across_ - 1); ++bi) {
                        const int from = std::max(first, bi * kBlock), to = std::min(last, (bi + 1) * kBlock);
                        if (to < from) continue;
                        const auto block = static_cast<std::size_t>(bj) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(bi);
                        std::memcpy(samples.data() + block * kNodes + (j - bj * kBlock) * kStride + (from - bi * kBlock), line + (from - column),
                                    static_cast<std::size_t>(to - from + 1) * sizeof(T));
                    }
                }
            }
        },
        samples_);
}

void HeightGrid::set(int column, int row, double sample)
{
    std::visit(
        [&](auto& samples) {
            using T = typename std::decay_t<decltype(samples)>::value_type;
            const auto value = static_cast<T>(sample);
            fill(column, row, 1, 1, &value, sizeof(T));
        },
        samples_);
}

float HeightGrid::steepness(double h00, double h10, double h01, double h11) const
{
    const double kx = frame_.scale / frame_.cell.x, ky = frame_.scale / frame_.cell.y;
    const double steepest = std::max(std::hypot((h10 - h00) * kx, (h01 - h00) * ky), std::hypot((h11 - h01) * kx, (h11 - h10) * ky));
    return std::nextafter(static_cast<float>(steepest * (1.0 + 0x1p-40)), std::numeric_limits<float>::infinity());
}

template <class T>
GridSummary HeightGrid::summarise_block(int bi, int bj) const
{
    const T* nodes = block<T>(bj * across_ + bi);
    const int across = std::min(kBlock, columns_ - 1 - bi * kBlock), up = std::min(kBlock, rows_ - 1 - bj * kBlock);
    GridSummary known = kNothing;
    for (int j = 0; j <= up; ++j) {
        for (int i = 0; i <= across; ++i) {
            const T* p = nodes + j * kStride + i;
            known.lo = std::min(known.lo, static_cast<float>(*p));
            known.hi = std::max(known.hi, static_cast<float>(*p));
            if (i < across && j < up) known.slope = std::max(known.slope, steepness(p[0], p[1], p[kStride], p[kStride + 1]));
        }
    }
    return known;
}

void HeightGrid::summarise()
{
    levels_.assign(1, std::vector<GridSummary>(static_cast<std::size_t>(across_) * static_cast<std::size_t>(up_)));
    sizes_.assign(1, {across_, up_});
    std::visit(
        [&](const auto& samples) {
            using T = typename std::decay_t<decltype(samples)>::value_type;
            tbb::parallel_for(0, up_, [&](int bj) {
                for (int bi = 0; bi < across_; ++bi) levels_[0][static_cast<std::size_t>(bj * across_ + bi)] = summarise_block<T>(bi, bj);
            });
        },
        samples_);
    while (sizes_.back().first > 1 || sizes_.back().second > 1) {
        const auto [w, h] = sizes_.back();
        const std::vector<GridSummary>& below = levels_.back();
        const int across = (w + 1) / 2, up = (h + 1) / 2;
        std::vector<GridSummary> level(static_cast<std::size_t>(across) * static_cast<std::size_t>(up), kNothing);
        for (int j = 0; j < h; ++j) {
            for (int i = 0; i < w; ++i) {
                GridSummary& known = level[static_cast<std::size_t>(j / 2 * across + i / 2)];
                known = merged(known, below[static_cast<std::size_t>(j * w + i)]);
            }
        }
        levels_.push_back(std::move(level));
        sizes_.emplace_back(across, up);
    }
}

std::uint64_t HeightGrid::sample_bytes() const
{
    return std::visit([](const auto& samples) -> std::uint64_t { return samples.capacity() * sizeof(samples[0]); }, samples_);
}

std::uint64_t HeightGrid::summary_bytes() const
{
    std::uint64_t bytes = 0;
    for (const auto& level : levels_) bytes += level.capacity() * sizeof(GridSummary);
    return bytes;
}

Vec2d HeightGrid::grid_point(const Vec2d& p) const
{
    return {std::clamp((p.x - frame_.origin.x) / frame_.cell.x, 0.0, columns_ - 1.0),
            std::clamp((p.y - frame_.origin.y) / frame_.cell.y, 0.0, rows_ - 1.0)};
}

HeightGrid::Facet HeightGrid::facet(int column, int row, bool upper, const Vec2d& p) const
{
    const double u = (p.x - frame_.origin.x) / frame_.cell.x - column, v = (p.y - frame_.origin.y) / frame_.cell.y - row;
    const double h10 = sample(column + 1, row), h01 = sample(column, row + 1), corner = sample(column + upper, row + upper);
    const double du = upper ? corner - h01 : h10 - corner, dv = upper ? corner - h10 : h01 - corner;
    return {frame_.origin.z + frame_.scale * (corner + du * (upper ? u - 1.0 : u) + dv * (upper ? v - 1.0 : v)),
            Vec2d(du / frame_.cell.x, dv / frame_.cell.y) * frame_.scale};
}

double HeightGrid::height(const Vec2d& p) const
{
    const Vec2d g = grid_point(p);
    const int i = std::min(static_cast<int>(g.x), columns_ - 2), j = std::min(static_cast<int>(g.y), rows_ - 2);
    return facet(i, j, g.x - i + (g.y - j) > 1.0, {frame_.origin.x + g.x * frame_.cell.x, frame_.origin.y + g.y * frame_.cell.y}).height;
}

Vec2d HeightGrid::gradient(const Vec2d& p) const
{
    const Vec2d g = grid_point(p);
    const int i = std::min(static_cast<int>(g.x), columns_ - 2), j = std::min(static_cast<int>(g.y), rows_ - 2);
    Vec2d gradient = facet(i, j, g.x - i + (g.y - j) > 1.0, p).gradient;
    const Box2d inside = domain();
    if (p.x < inside.min.x || p.x > inside.max.x) gradient.x = 0.0;
    if (p.y < inside.min.y || p.y > inside.max.y) gradient.y = 0.0;
    return gradient;
}

Vec3d HeightGrid::smooth_normal(const Vec2d& p) const
{
    const Vec2d g = grid_point(p);
    const int i = std::min(static_cast<int>(g.x), columns_ - 2), j = std::min(static_cast<int>(g.y), rows_ - 2);
    const double u = g.x - i, v = g.y - j;
    // One-sided at the grid's border.
    const auto at = [&](int column, int row) {
        const int west = std::max(column - 1, 0), east = std::min(column + 1, columns_ - 1), south = std::max(row - 1, 0),
                  north = std::min(row + 1, rows_ - 1);
        const double x = frame_.scale * (sample(east, row) - sample(west, row)) / ((east - west) * frame_.cell.x);
        const double y = frame_.scale * (sample(column, north) - sample(column, south)) / ((north - south) * frame_.cell.y);
        return Vec3d(-x, -y, 1.0).normalized();
    };
    const Vec3d low = at(i, j) * (1.0 - u) + at(i + 1, j) * u, high = at(i, j + 1) * (1.0 - u) + at(i + 1, j + 1) * u;
    return (low * (1.0 - v) + high * v).normalized();
}

HeightGrid::Cells HeightGrid::cells_of(const Box2d& area) const
{
    // A little more than the area: where a point lies on a line of the grid, its own rounding must not choose the cell.
    const Vec2d lo = grid_point(area.min), hi = grid_point(area.max);
    const Vec2d hair = (lo + hi + Vec2d(std::abs(frame_.origin.x / frame_.cell.x), std::abs(frame_.origin.y / frame_.cell.y)) + Vec2d(1.0)) * 0x1p-50;
    const auto cell = [](double x, int last) { return std::clamp(static_cast<int>(std::floor(x)), 0, last); };
    return {cell(lo.x - hair.x, columns_ - 2), cell(hi.x + hair.x, columns_ - 2), cell(lo.y - hair.y, rows_ - 2), cell(hi.y + hair.y, rows_ - 2)};
}

GridSummary HeightGrid::gather(const Cells& cells, std::size_t level, int bi, int bj) const
{
    const int side = kBlock << level, i0 = bi * side, j0 = bj * side;
    if (i0 > cells.i1 || i0 + side <= cells.i0 || j0 > cells.j1 || j0 + side <= cells.j0) return kNothing;
    const auto [w, h] = sizes_[level];
    const int last_i = std::min(i0 + side, columns_ - 1) - 1, last_j = std::min(j0 + side, rows_ - 1) - 1;
    if (cells.i0 <= i0 && last_i <= cells.i1 && cells.j0 <= j0 && last_j <= cells.j1) return levels_[level][static_cast<std::size_t>(bj * w + bi)];
    GridSummary known = kNothing;
    if (level == 0) {
        for (int j = std::max(j0, cells.j0); j <= std::min(last_j, cells.j1); ++j) {
            for (int i = std::max(i0, cells.i0); i <= std::min(last_i, cells.i1); ++i) {
                const double a = sample(i, j), b = sample(i + 1, j), c = sample(i, j + 1), d = sample(i + 1, j + 1);
                known =
                    merged(known, {static_cast<float>(std::min({a, b, c, d})), static_cast<float>(std::max({a, b, c, d})), steepness(a, b, c, d)});
            }
        }
        return known;
    }
    const auto [below_w, below_h] = sizes_[level - 1];
    for (int j = 2 * bj; j < std::min(2 * bj + 2, below_h); ++j)
        for (int i = 2 * bi; i < std::min(2 * bi + 2, below_w); ++i) known = merged(known, gather(cells, level - 1, i, j));
    return known;
}

GridSummary HeightGrid::over(const Cells& cells) const
{
    return gather(cells, levels_.size() - 1, 0, 0);
}

Interval HeightGrid::range(const Box2d& area) const
{
    const GridSummary known = over(cells_of(area));
    const double lo = frame_.origin.z + frame_.scale * known.lo, hi = frame_.origin.z + frame_.scale * known.hi;
    const double rounding = 0x1p-48 * (std::abs(frame_.origin.z) + std::abs(lo) + std::abs(hi));
    return {lo - rounding, hi + rounding};
}

double HeightGrid::slope_bound(const Box2d& area) const
{
    return over(cells_of(area)).slope;
}

Box2d HeightGrid::domain() const
{
    const Vec2d low(frame_.origin.x, frame_.origin.y);
    return {low, low + Vec2d((columns_ - 1) * frame_.cell.x, (rows_ - 1) * frame_.cell.y)};
}

std::unique_ptr<HeightGrid> halved(const HeightGrid& grid)
{
    GridFrame frame = grid.frame();
    frame.cell *= 2.0;
    auto half = std::make_unique<HeightGrid>(frame, grid.columns() / 2 + 1, grid.rows() / 2 + 1, SampleType::f32);
    for (int j = 0; j < half->rows(); ++j) {
        for (int i = 0; i < half->columns(); ++i) {
            double sum = 0.0;
            for (int b = -1; b <= 1; ++b)
                for (int a = -1; a <= 1; ++a)
                    sum += (2 - std::abs(a)) * (2 - std::abs(b)) *
                           grid.sample(std::clamp(2 * i + a, 0, grid.columns() - 1), std::clamp(2 * j + b, 0, grid.rows() - 1));
            half->set(i, j, sum / 16.0);
        }
    }
    half->summarise();
    return half;
}

}  // namespace hoodoo
