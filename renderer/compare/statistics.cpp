// Two pictures of the same light differ by noise alone; regions, not pixels, show whether they differ by more.
//
// A one per cent change hides in every single pixel and is plain in the sum of a thousand. So the light is summed over regions: the picture, each
// object, each material, blocks. Pixels do not share samples, so with va, vb the variances of the pixel means
//     t = sum (b - a) / sqrt(sum (va + vb)),
// whose degrees of freedom follow from those of each pixel's variance, replicates - 1 (Welch1947, its general form):
//     nu = (sum (va + vb))^2 / (sum va^2 / (Ra - 1) + sum vb^2 / (Rb - 1)).
// The sums are not weighted by the inverse variance: where noise is skewed, dark pixels look certain, and weights would turn noise into bias.
// The allowed false alarms are shared evenly among all tests (Bonferroni), which holds however the tests depend on each other.
// Values were stored as floats: differences below one part in a million of the sums are rounding and no evidence.
//
// Missing: tests of the other channels, of the distribution of single pixels, reports as pictures.
#include "renderer/compare/statistics.h"

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace hoodoo
{

namespace
{

constexpr double rounding = 1e-6;
constexpr std::array<const char*, 3> colors = {"R", "G", "B"};

struct Region {
    std::string name;
    std::vector<std::size_t> pixels;
};

int replicates_of(const Image& image)
{
    const auto found = image.metadata.find("hoodoo:replicates");
    const int* replicates = found == image.metadata.end() ? nullptr : std::get_if<int>(&found->second);
    return replicates ? *replicates : 0;
}

std::string obstacle(const Image& image, const char* which)
{
    if (replicates_of(image) < 2) return fmt::format("the {} picture states no variance between replicates", which);
    for (const char* color : colors)
        for (const std::string& name : {std::string(color), fmt::format("variance.{}", color)}) {
            const Channel* channel = image.find(name);
            if (!channel) return fmt::format("the {} picture has no channel {}", which, name);
            const auto bad = std::find_if_not(channel->pixels.begin(), channel->pixels.end(), [](float v) { return std::isfinite(v); });
            if (bad != channel->pixels.end())
                return fmt::format("channel {} of the {} picture has a value that is not finite, at pixel {} of its data window", name, which,
                                   bad - channel->pixels.begin());
        }
    return {};
}

std::string obstacle(const Image& reference, const Image& test)
{
    const PixelBounds &a = reference.data, &b = test.data;
    if (reference.width != test.width || reference.height != test.height || a.x0 != b.x0 || a.x1 != b.x1 || a.y0 != b.y0 || a.y1 != b.y1)
        return fmt::format("the pictures have different windows: {}x{} and {}x{}", a.width(), a.height(), b.width(), b.height());
    const std::string first = obstacle(reference, "reference");
    return first.empty() ? obstacle(test, "test") : first;
}

std::vector<Region> regions_of(const Image& image, const CompareSettings& settings)
{
    const std::size_t width = static_cast<std::size_t>(image.data.width()), count = width * image.data.height();
    std::map<std::string, Region> masks, blocks;
    Region all{"picture", {}};
    const Channel* ids = image.find("objectId");
    for (std::size_t i = 0; i < count; ++i) {
        all.pixels.push_back(i);
        const std::size_t x = i % width / settings.block * settings.block, y = i / width / settings.block * settings.block;
        blocks[fmt::format("block {},{}", x, y)].pixels.push_back(i);
        if (ids) masks[ids->pixels[i] > 0.0f ? fmt::format("object {}", ids->pixels[i]) : "sky"].pixels.push_back(i);
        for (const Channel& channel : image.channels)
            if (channel.name.rfind("material.", 0) == 0 && channel.pixels[i] > 0.5f) masks["material " + channel.name.substr(9)].pixels.push_back(i);
    }
    std::vector<Region> regions = {std::move(all)};
    for (auto& [name, region] : masks)
        if (region.pixels.size() >= static_cast<std::size_t>(settings.smallest_mask)) regions.push_back({name, std::move(region.pixels)});
    for (auto& [name, region] : blocks) regions.push_back({name, std::move(region.pixels)});
    return regions;
}

/// `alarm`: two-sided chance of a false alarm of this one test.
RegionTest test_region(const Region& region, const std::string& color, const Image& reference, const Image& test, double alarm, double power)
{
    const std::vector<float>&a = reference.find(color)->pixels, &b = test.find(color)->pixels;
    const std::vector<float>&va = reference.find("variance." + color)->pixels, &vb = test.find("variance." + color)->pixels;
    double sum_a = 0.0, sum_b = 0.0, size = 0.0, variance = 0.0, squares_a = 0.0, squares_b = 0.0;
    for (const std::size_t i : region.pixels) {
        sum_a += a[i];
        sum_b += b[i];
        size += std::abs(a[i]) + std::abs(b[i]);
        variance += static_cast<double>(va[i]) + vb[i];
        squares_a += static_cast<double>(va[i]) * va[i];
        squares_b += static_cast<double>(vb[i]) * vb[i];
    }
    const double count = static_cast<double>(region.pixels.size());
    RegionTest result{region.name, color, static_cast<std::int64_t>(region.pixels.size()), sum_a / count, sum_b / count, 0.0, 1.0, 0.0};
    const double difference = std::max(0.0, std::abs(sum_b - sum_a) - rounding * size);
    const double error = std::sqrt(variance);
    if (error == 0.0) {
        // Without noise the rounding alone decides.
        result.t = difference > 0.0 ? std::copysign(kInfinity, sum_b - sum_a) : 0.0;
        result.probability = difference > 0.0 ? 0.0 : 1.0;
        return result;
    }
    const double freedom = variance * variance / (squares_a / (replicates_of(reference) - 1) + squares_b / (replicates_of(test) - 1));
    const boost::math::students_t student(freedom);
    result.t = std::copysign(difference / error, sum_b - sum_a);
    result.probability = 2.0 * boost::math::cdf(boost::math::complement(student, difference / error));
    const double needed = boost::math::quantile(boost::math::complement(student, alarm / 2.0)) + boost::math::quantile(boost::math::normal(), power);
    result.detectable = sum_a != 0.0 ? needed * error / std::abs(sum_a) : kInfinity;
    return result;
}

}  // namespace

Comparison compare_statistically(const Image& reference, const Image& test, const CompareSettings& settings)
{
    Comparison result;
    result.problem = obstacle(reference, test);
    if (!result.problem.empty()) return result;
    const std::vector<Region> regions = regions_of(reference, settings);
    const double alarm = settings.false_alarm / static_cast<double>(regions.size() * colors.size());
    result.same = true;
    for (const Region& region : regions)
        for (const char* color : colors) {
            result.regions.push_back(test_region(region, color, reference, test, alarm, settings.power));
            const RegionTest& made = result.regions.back();
            result.same = result.same && made.probability >= alarm;
            if (&region == &regions.front()) result.detectable = std::max(result.detectable, made.detectable);
        }
    std::stable_sort(result.regions.begin(), result.regions.end(),
                     [](const RegionTest& a, const RegionTest& b) { return a.probability < b.probability; });
    return result;
}

std::string Comparison::text() const
{
    if (!problem.empty()) return "cannot be compared: " + problem + "\n";
    std::string text = fmt::format("{}; a change of the whole picture by {:.2g}% would have been found\n",
                                   same ? "the same light" : "different light", 100.0 * detectable);
    for (std::size_t i = 0; i < std::min<std::size_t>(regions.size(), 5); ++i) {
        const RegionTest& r = regions[i];
        text += fmt::format("  {} {}: {:.6g} -> {:.6g}, t = {:.2f}, p = {:.2g} ({} pixels)\n", r.region, r.channel, r.reference, r.test, r.t,
                            r.probability, r.pixels);
    }
    return text;
}

}  // namespace hoodoo
