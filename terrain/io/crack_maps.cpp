// The paper's intermediate products (Li2023, equations 1 and 4, figure 2), sampled from the field that is traced, not computed a second time.
// The cracks of the drawing are strokes of the true width along the borders, left out where iota says that they have no depth. Missing: nothing.
#include "terrain/io/crack_maps.h"

#include "terrain/error.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

template <class Value>
HeightImage sampled(const CrackedField& field, double cell, const Value& value)
{
    const Vec2d size = field.region().size();
    const double columns = std::max(1.0, std::floor(size.x / cell * (1.0 + 1e-12))), rows = std::max(1.0, std::floor(size.y / cell * (1.0 + 1e-12)));
    if (columns * rows > 134217728.0)
        throw Error(ErrorKind::scene, Problem{{},
                                              "the picture is too large",
                                              "at most 134217728 pixels: a larger cell",
                                              fmt::format("{:.0f} x {:.0f} of {:.6g} m", columns, rows, cell),
                                              {}});
    HeightImage image;
    image.width = static_cast<int>(columns);
    image.height = static_cast<int>(rows);
    image.cell = cell;
    image.values.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    tbb::parallel_for(0, image.height, [&](int row) {
        for (int column = 0; column < image.width; ++column)
            image.at(column, row) = static_cast<float>(value(field.region().min + Vec2d(column + 0.5, image.height - 1 - row + 0.5) * cell));
    });
    return image;
}

constexpr double kPanel = 400.0, kGap = 20.0;

/// One of the drawings: the region, y upwards, on a page with y downwards.
struct Panel {
    const CrackedField& field;
    Drawing& page;
    double shift, scale, height;

    Vec2d at(const Vec2d& local) const { return {shift + local.x * scale, 0.5 * kGap + height - local.y * scale}; }
    void line(const Vec2d& a, const Vec2d& b, const Drawing::Colour& colour, double width) const { page.line(at(a), at(b), colour, width); }
    void clip() const { page.clip_to({shift, 0.5 * kGap}, {shift + kPanel, 0.5 * kGap + height}); }
    void frame() const
    {
        const Vec2d low(shift, 0.5 * kGap), high(shift + kPanel, 0.5 * kGap + height);
        const Drawing::Colour grey{70, 70, 70};
        page.line(low, {high.x, low.y}, grey, 1.0);
        page.line({high.x, low.y}, high, grey, 1.0);
        page.line(high, {low.x, high.y}, grey, 1.0);
        page.line({low.x, high.y}, low, grey, 1.0);
    }
};

void draw_sites(const Panel& panel)
{
    for (const Vec2d& site : panel.field.network().diagram().sites()) panel.line(site, site, {30, 30, 30}, 4.0);
}

void draw_diagram(const Panel& panel)
{
    const VoronoiDiagram& diagram = panel.field.network().diagram();
    const auto sites = diagram.sites();
    for (const auto& triangle : diagram.triangles())
        for (std::size_t k = 0; k < 3; ++k) panel.line(sites[triangle[k]], sites[triangle[(k + 1) % 3]], {170, 185, 205}, 0.7);
    for (const VoronoiDiagram::Edge& edge : diagram.edges()) panel.line(edge.a, edge.b, {165, 45, 30}, 1.2);
}

void draw_cracks(const Panel& panel)
{
    const CrackedField& field = panel.field;
    // The ground's height as grey, in squares of 4 units.
    const Vec2d size = field.region().size();
    const double step = 4.0 / panel.scale;
    for (double y = 0.0; y < size.y; y += step) {
        for (double x = 0.0; x < size.x; x += step) {
            const double height = field.ground().height(field.region().min + Vec2d(x + 0.5 * step, y + 0.5 * step));
            const auto grey = static_cast<std::uint8_t>(45.0 + 210.0 * std::clamp((height - field.zero()) / (field.one() - field.zero()), 0.0, 1.0));
            panel.page.rectangle(panel.at({x, y + step}), panel.at({x + step, y}), {grey, grey, grey});
        }
    }
    for (const VoronoiDiagram::Edge& edge : field.network().diagram().edges()) {
        // In pieces of 4 units, each as dark as its crack is deep.
        const int pieces = std::max(1, static_cast<int>((edge.b - edge.a).length() / step));
        for (int k = 0; k < pieces; ++k) {
            const Vec2d a = edge.a + (edge.b - edge.a) * (1.0 * k / pieces), b = edge.a + (edge.b - edge.a) * ((k + 1.0) / pieces);
            if (field.iota(field.region().min + (a + b) * 0.5) > 0.0) panel.line(a, b, {32, 18, 8}, field.network().width() * panel.scale);
        }
    }
}

}  // namespace

HeightImage crack_map(const CrackedField& field, double cell)
{
    return sampled(field, cell, [&](const Vec2d& p) { return field.cracked(p) ? 1.0 : 0.0; });
}

HeightImage cracked_heights(const CrackedField& field, double cell)
{
    return sampled(field, cell, [&](const Vec2d& p) { return field.height(p); });
}

Drawing crack_diagram(const CrackedField& field)
{
    const Vec2d size = field.region().size();
    const double scale = kPanel / size.x, height = size.y * scale;
    Drawing page(3.0 * (kPanel + kGap), height + kGap);
    double shift = 0.5 * kGap;
    for (const auto& draw : {draw_sites, draw_diagram, draw_cracks}) {
        const Panel panel{field, page, shift, scale, height};
        panel.clip();
        draw(panel);
        panel.frame();
        shift += kPanel + kGap;
    }
    return page;
}

}  // namespace hoodoo
