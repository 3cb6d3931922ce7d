// Everything is asked of the field that is traced, or of rays against the one terrain; nothing is meshed on the way.
// Outlines and contours are marching squares: each square's sides are crossed where a straight line between its corners' values is zero; of the two
// ways to join four crossings the mean of the corners decides. Missing: contours of what lies under an overhang (a height is the highest point).
#include "renderer/survey.h"

#include "renderer/geometry/tracer.h"
#include "renderer/scene/terrain.h"
#include "terrain/error.h"
#include "terrain/io/polygonise.h"
#include "terrain/math/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hoodoo
{

namespace
{

double least(const std::vector<const Field*>& fields, const Vec3d& p)
{
    double f = kInfinity;
    for (const Field* field : fields) f = std::min(f, field->value(p));
    return f;
}

/// Calls line(a, b) for the zero of f in each square of a lattice; (i, j) of the nodes, f in rows. A square with a NaN has none.
template <class Line>
void marching_squares(const std::vector<double>& f, int columns, int rows, const Line& line)
{
    const auto at = [&](int i, int j) { return f[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i)]; };
    for (int j = 0; j + 1 < rows; ++j) {
        for (int i = 0; i + 1 < columns; ++i) {
            const std::array<Vec2d, 4> corner{Vec2d(i, j), Vec2d(i + 1, j), Vec2d(i + 1, j + 1), Vec2d(i, j + 1)};
            const std::array<double, 4> value{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
            if (!std::isfinite(value[0] + value[1] + value[2] + value[3])) continue;
            std::array<Vec2d, 4> crossing;
            std::size_t count = 0;
            bool first_corner_alone = false;
            for (std::size_t k = 0; k < 4; ++k) {
                const double a = value[k], b = value[(k + 1) % 4];
                if ((a < 0.0) != (b < 0.0)) crossing[count++] = corner[k] + (corner[(k + 1) % 4] - corner[k]) * (a / (a - b));
            }
            if (count == 2) line(crossing[0], crossing[1]);
            if (count != 4) continue;
            // Sides 0 and 3 meet at the first corner: it stands alone if the middle is on the other side.
            first_corner_alone = (value[0] < 0.0) != (value[0] + value[1] + value[2] + value[3] < 0.0);
            line(crossing[0], crossing[first_corner_alone ? 3 : 1]);
            line(crossing[2], crossing[first_corner_alone ? 1 : 3]);
        }
    }
}

constexpr Drawing::Colour kMatter{206, 196, 182}, kOutline{70, 45, 25}, kContour{150, 105, 60};

}  // namespace

std::vector<const Field*> SurveyedTerrain::fields() const
{
    const std::vector<const Field*> all = surface ? surface->fields() : std::vector<const Field*>{};
    if (all.empty())
        throw Error(ErrorKind::scene,
                    Problem{where, "a terrain without a field has no samples", "a type with a field, such as convolution", '"' + name + '"', {}});
    return all;
}

SurveyedTerrain survey(const LoadedScene& loaded, const std::string& name)
{
    const DescribedNode& node = choose_terrain(loaded.description, name);
    const auto& objects = loaded.scene->objects();
    const auto found = std::find_if(objects.begin(), objects.end(), [&](const SceneObject& object) { return object.name == node.name; });
    if (found == objects.end())
        throw Error(ErrorKind::scene, Problem{node.where, "this terrain is not shown: another one stands on it", "visible = true", {}, {}});
    SurveyedTerrain terrain;
    terrain.shape = &loaded.scene->shapes()[static_cast<std::size_t>(found - objects.begin())];
    terrain.name = node.name;
    terrain.where = node.where;
    if (const auto* surface = std::get_if<std::unique_ptr<Surface>>(terrain.shape)) {
        terrain.surface = surface->get();
        for (std::uint32_t tile = 0; tile < terrain.surface->tile_count(); ++tile)
            for (std::uint32_t k = 0; k < terrain.surface->patch_count(tile); ++k) terrain.bounds.extendBy(terrain.surface->patch_bounds({tile, k}));
    } else if (const auto* mesh = std::get_if<TriangleMesh>(terrain.shape)) {
        terrain.bounds = mesh_bounds(*mesh);
    }
    return terrain;
}

/// Of pixels whose outer corner of row 0 lies at `corner` (north-west), `step` metres wide and high. Unknown where the terrain's is.
static GeoReference place_of(const SurveyedTerrain& terrain, const Vec2d& corner, const Vec2d& step)
{
    const auto* placed = dynamic_cast<const Georeferenced*>(terrain.surface);
    return placed ? placed->world_to_earth().of_pixels(corner.x, corner.y, step.x, -step.y) : GeoReference{};
}

SampledGrid sample_field(const SurveyedTerrain& terrain, const Box3d& box, const std::array<int, 3>& count)
{
    const std::vector<const Field*> fields = terrain.fields();
    SampledGrid grid;
    grid.count = count;
    for (int k = 0; k < 3; ++k) {
        const int n = count[static_cast<std::size_t>(k)];
        grid.step[k] = n > 1 ? (box.max[k] - box.min[k]) / (n - 1) : box.max[k] - box.min[k];
        grid.origin[k] = n > 1 ? box.min[k] : 0.5 * (box.min[k] + box.max[k]);
    }
    grid.place = place_of(terrain, {grid.origin.x - 0.5 * grid.step.x, grid.origin.y + (count[1] - 0.5) * grid.step.y}, {grid.step.x, grid.step.y});
    const auto slice = static_cast<std::size_t>(count[1]) * static_cast<std::size_t>(count[2]);
    grid.values.resize(static_cast<std::size_t>(count[0]) * slice);
    parallel_items(static_cast<std::size_t>(count[0]), [&](std::size_t i) {
        std::size_t next = i * slice;
        for (int j = 0; j < count[1]; ++j)
            for (int k = 0; k < count[2]; ++k) grid.values[next++] = least(fields, grid.origin + grid.step * Vec3d(static_cast<double>(i), j, k));
    });
    return grid;
}

HeightImage heights_from_above(const SurveyedTerrain& terrain, const Imath::Box2d& area, double cell)
{
    const Vec2d size = area.size();
    const double columns = std::max(1.0, std::floor(size.x / cell * (1.0 + 1e-12))), rows = std::max(1.0, std::floor(size.y / cell * (1.0 + 1e-12)));
    if (!(columns * rows <= 134217728.0))
        throw Error(ErrorKind::scene, Problem{terrain.where,
                                              "too many heights",
                                              "at most 134217728: a larger cell or a smaller area",
                                              fmt::format("{:.0f} x {:.0f} of {:.6g} m", columns, rows, cell),
                                              {}});
    HeightImage image;
    image.width = static_cast<int>(columns);
    image.height = static_cast<int>(rows);
    image.cell = cell;
    image.place = place_of(terrain, {area.min.x, area.min.y + rows * cell}, Vec2d(cell));
    image.values.assign(static_cast<std::size_t>(columns * rows), std::numeric_limits<float>::quiet_NaN());
    // A tracer of its own: what else the scene shows is not in the way.
    const std::unique_ptr<Tracer> tracer = make_embree_tracer(std::span(terrain.shape, 1));
    const double top = std::isfinite(terrain.bounds.max.z) ? terrain.bounds.max.z : 1e5;
    const double above = 1.0 + 1e-3 * (terrain.bounds.isEmpty() ? 1.0 : std::abs(top));
    parallel_items(static_cast<std::size_t>(image.height), [&](std::size_t row) {
        for (int column = 0; column < image.width; ++column) {
            Ray ray;
            ray.origin =
                Vec3d(area.min.x + (column + 0.5) * cell, area.min.y + (image.height - 1 - static_cast<double>(row) + 0.5) * cell, top + above);
            ray.direction = Vec3d(0.0, 0.0, -1.0);
            const TraceHit hit = tracer->intersect(ray);
            if (hit.valid) image.at(column, static_cast<int>(row)) = static_cast<float>(tracer->interact(ray, hit).position.z);
        }
    });
    return image;
}

Drawing draw_section(const SurveyedTerrain& terrain, const Vec2d& from, const Vec2d& to, const Interval& heights, int columns)
{
    const std::vector<const Field*> fields = terrain.fields();
    const double length = (to - from).length(), unit = length / columns, tall = heights.hi - heights.lo;
    const int nx = columns + 1, nz = std::max(2, static_cast<int>(std::ceil(tall / unit)) + 1);
    const Vec2d along = (to - from) / length;
    std::vector<double> f(static_cast<std::size_t>(nx) * static_cast<std::size_t>(nz));
    parallel_items(static_cast<std::size_t>(nz), [&](std::size_t j) {
        const double z = heights.hi - static_cast<double>(j) * unit;
        for (int i = 0; i < nx; ++i) {
            const Vec2d p = from + along * (i * unit);
            f[j * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)] = least(fields, Vec3d(p.x, p.y, z));
        }
    });
    Drawing page(columns, nz - 1);
    // Matter, run by run of squares whose middle is in it.
    for (int j = 0; j + 1 < nz; ++j) {
        const auto middle = [&](int i) {
            const std::size_t k = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
            return f[k] + f[k + 1] + f[k + static_cast<std::size_t>(nx)] + f[k + static_cast<std::size_t>(nx) + 1];
        };
        for (int i = 0; i + 1 < nx;) {
            int end = i;
            while (end + 1 < nx && middle(end) < 0.0) ++end;
            if (end > i) page.rectangle(Vec2d(i, j), Vec2d(end, j + 1), kMatter);
            i = end + 1;
        }
    }
    marching_squares(f, nx, nz, [&](const Vec2d& a, const Vec2d& b) { page.line(a, b, kOutline, 1.5); });
    return page;
}

Drawing draw_contours(const HeightImage& heights, double interval, double scale)
{
    Drawing page(heights.width * scale, heights.height * scale);
    double low = kInfinity, high = -kInfinity;
    for (const float z : heights.values)
        if (std::isfinite(z)) low = std::min<double>(low, z), high = std::max<double>(high, z);
    std::vector<double> above(heights.values.size());
    const auto first = static_cast<std::int64_t>(std::ceil(low / interval));
    for (std::int64_t n = first; low <= high && static_cast<double>(n) * interval <= high; ++n) {
        const double level = static_cast<double>(n) * interval;
        std::transform(heights.values.begin(), heights.values.end(), above.begin(), [&](float z) { return z - level; });
        const bool heavy = n % 5 == 0;
        bool named = false;
        marching_squares(above, heights.width, heights.height, [&](const Vec2d& a, const Vec2d& b) {
            const Vec2d p = (a + Vec2d(0.5)) * scale, q = (b + Vec2d(0.5)) * scale;
            page.line(p, q, kContour, heavy ? 1.6 : 0.7);
            if (heavy && !named) page.text(p, fmt::format("{:.6g}", level), 9.0);
            named = true;
        });
    }
    return page;
}

MeshError mesh_error(const SurveyedTerrain& terrain, const TriangleMesh& mesh, double reach)
{
    const std::vector<const Field*> fields = terrain.fields();
    const auto distance = [&](const Vec3d& p) {
        double d = reach;
        for (const Field* field : fields) d = std::min(d, distance_along_gradient(*field, p, reach));
        return d;
    };
    struct Measured {
        double area, mean, square, maximum;
    };
    std::vector<Measured> measured(mesh.triangles.size());
    parallel_items((measured.size() + 255) / 256, [&](std::size_t chunk) {
        for (std::size_t n = 256 * chunk; n < std::min(measured.size(), 256 * chunk + 256); ++n) {
            const auto corner = [&](std::size_t k) { return mesh.origin + Vec3d(mesh.vertices[mesh.triangles[n][k]]); };
            const Vec3d a = corner(0), b = corner(1), c = corner(2);
            Measured m{0.5 * (b - a).cross(c - a).length(), 0.0, 0.0, 0.0};
            for (const Vec3d& p : {(a + b + c) / 3.0, (a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5}) {
                const double d = distance(p);
                m.mean += 0.25 * d;
                m.square += 0.25 * d * d;
                m.maximum = std::max(m.maximum, d);
            }
            for (const Vec3d& p : {a, b, c}) m.maximum = std::max(m.maximum, distance(p));
            measured[n] = m;
        }
    });
    MeshError error;
    error.triangles = measured.size();
    for (const Measured& m : measured) {
        error.area += m.area;
        error.mean += m.area * m.mean;
        error.rms += m.area * m.square;
        error.maximum = std::max(error.maximum, m.maximum);
        error.far_triangles += m.maximum >= reach;
    }
    if (error.area > 0.0) {
        error.mean /= error.area;
        error.rms = std::sqrt(error.rms / error.area);
    }
    return error;
}

}  // namespace hoodoo
