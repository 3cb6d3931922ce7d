// Sand lies where it is flat and where it is low: slope from central differences, hollows from the difference to a box mean.
// No paper. The mean comes from two passes of running sums, so that its cost does not depend on the reach. Edges are repeated.
#include "terrain/surfaces/drift.h"

#include "terrain/math/smoothstep.h"

#include <algorithm>

namespace hoodoo
{

namespace
{

std::vector<double> box_mean_along_x(const std::vector<double>& values, Vec2i size, int reach)
{
    std::vector<double> mean(values.size());
    for (int j = 0; j < size.y; ++j) {
        const double* row = values.data() + static_cast<std::size_t>(j) * size.x;
        const auto at = [&](int i) { return row[std::clamp(i, 0, size.x - 1)]; };
        double sum = 0.0;
        for (int i = -reach; i <= reach; ++i) sum += at(i);
        for (int i = 0; i < size.x; ++i) {
            mean[static_cast<std::size_t>(j) * size.x + i] = sum / (2 * reach + 1);
            sum += at(i + reach + 1) - at(i - reach);
        }
    }
    return mean;
}

std::vector<double> transposed(const std::vector<double>& values, Vec2i size)
{
    std::vector<double> turned(values.size());
    for (int j = 0; j < size.y; ++j) {
        for (int i = 0; i < size.x; ++i) turned[static_cast<std::size_t>(i) * size.y + j] = values[static_cast<std::size_t>(j) * size.x + i];
    }
    return turned;
}

}  // namespace

std::vector<double> drift_thickness(const std::vector<double>& ground, Vec2i size, double cell, const Drift& drift)
{
    const int reach = static_cast<int>(std::clamp(drift.reach / cell, 1.0, static_cast<double>(std::max(size.x, size.y))));
    const std::vector<double> rows = transposed(box_mean_along_x(ground, size, reach), size);
    const std::vector<double> mean = transposed(box_mean_along_x(rows, {size.y, size.x}, reach), {size.y, size.x});
    std::vector<double> thickness(ground.size());
    for (int j = 0; j < size.y; ++j) {
        for (int i = 0; i < size.x; ++i) {
            const auto at = [&](int x, int y) {
                return ground[static_cast<std::size_t>(std::clamp(y, 0, size.y - 1)) * size.x + std::clamp(x, 0, size.x - 1)];
            };
            const double slope = std::atan(std::hypot(at(i + 1, j) - at(i - 1, j), at(i, j + 1) - at(i, j - 1)) / (2.0 * cell));
            const double bears = smoothstep((drift.steep - slope) / (drift.steep - drift.flat));
            const std::size_t c = static_cast<std::size_t>(j) * size.x + i;
            const double hollow = std::max(0.0, mean[c] - ground[c]);
            thickness[c] = bears * (drift.thickness + drift.fill * hollow);
        }
    }
    return thickness;
}

}  // namespace hoodoo
