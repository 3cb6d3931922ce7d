// A layer stack as deep OpenEXR: a column is a pixel, a layer a sample that reaches from Z to ZBack.
//
// Any program that reads deep images can look at it, flatten it or merge it: that is why heights are metres in floats, why air is a gap, and why
// there is an alpha of 1. Nothing is lost: a float holds each of 8191 steps to better than a thousandth of a step, and cell, unit and origin are
// doubles in the header. Deep images allow zips at most, one row a chunk; rows are written and read one by one, so that only one row is ever
// unpacked. What a file promises is checked before memory is taken: deflate cannot pass 1032 bytes for each byte stored. Missing: several stacks in
// one file, tiles.
#include "terrain/io/stack_file.h"

#include "terrain/io/atomic_file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputFile.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringVectorAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace hoodoo
{

namespace
{

constexpr int format_version = 1;
constexpr double max_columns = 134217728.0;  // as many as a scene may ask for
constexpr double max_expansion = 1032.0;

/// OpenEXR's stream on top of our sink.
class SinkStream : public Imf::OStream
{
public:
    explicit SinkStream(ByteSink& sink) : OStream("stack"), sink_(sink) {}
    void write(const char bytes[], int count) override { sink_.write(bytes, static_cast<std::size_t>(count)); }
    std::uint64_t tellp() override { return sink_.tell(); }
    void seekp(std::uint64_t position) override { sink_.seek(position); }

private:
    ByteSink& sink_;
};

/// The samples of one row of pixels, and OpenEXR's view of them: strides of 0 between rows let every row use the same memory.
class Row
{
public:
    explicit Row(const Imath::Box2i& window) : counts(static_cast<std::size_t>(window.max.x - window.min.x + 1)), x0_(window.min.x)
    {
        for (auto* pointers : {&z_, &back_, &material_, &alpha_}) pointers->resize(counts.size());
    }

    Imf::DeepFrameBuffer frame_buffer(bool with_alpha)
    {
        Imf::DeepFrameBuffer buffer;
        buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data() - x0_), sizeof(unsigned), 0));
        const auto add = [&](const char* name, Imf::PixelType type, std::vector<char*>& pointers, std::size_t size) {
            buffer.insert(name, Imf::DeepSlice(type, reinterpret_cast<char*>(pointers.data() - x0_), sizeof(char*), 0, size));
        };
        add("Z", Imf::FLOAT, z_, sizeof(float));
        add("ZBack", Imf::FLOAT, back_, sizeof(float));
        add("material", Imf::UINT, material_, sizeof(unsigned));
        if (with_alpha) add("A", Imf::HALF, alpha_, sizeof(half));
        return buffer;
    }

    /// Makes room for the samples that `counts` promises.
    void arrange()
    {
        std::size_t total = 0;
        for (const unsigned count : counts) total += count;
        z.resize(total);
        back.resize(total);
        material.resize(total);
        alpha.assign(total, half(1.0f));
        std::size_t from = 0;
        for (std::size_t x = 0; x < counts.size(); from += counts[x++]) {
            z_[x] = reinterpret_cast<char*>(z.data() + from);
            back_[x] = reinterpret_cast<char*>(back.data() + from);
            material_[x] = reinterpret_cast<char*>(material.data() + from);
            alpha_[x] = reinterpret_cast<char*>(alpha.data() + from);
        }
    }

    std::vector<unsigned> counts, material;
    std::vector<float> z, back;
    std::vector<half> alpha;

private:
    int x0_;
    std::vector<char*> z_, back_, material_, alpha_;
};

Imf::Header make_header(const MaterialStack& stack)
{
    Imf::Header header(stack.size().x, stack.size().y);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    header.channels().insert("A", Imf::Channel(Imf::HALF));
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.channels().insert("ZBack", Imf::Channel(Imf::FLOAT));
    header.channels().insert("material", Imf::Channel(Imf::UINT));
    Imf::addComments(header,
                     "Layers of a terrain, one pixel a column, row 0 in the north. Samples from the bottom up: Z to ZBack in metres above "
                     "hoodoo:origin, material an index into hoodoo:materials. Gaps are air, below 0 there is bedrock.");
    header.insert("hoodoo:stack", Imf::IntAttribute(format_version));
    header.insert("hoodoo:cell", Imf::DoubleAttribute(stack.cell()));
    header.insert("hoodoo:unit", Imf::DoubleAttribute(stack.unit()));
    header.insert("hoodoo:origin", Imf::V3dAttribute(stack.origin()));
    Imf::StringVector names;
    for (std::size_t m = 0; m < kMaterialCount; ++m) names.push_back(material_name(static_cast<Material>(m)));
    header.insert("hoodoo:materials", Imf::StringVectorAttribute(names));
    return header;
}

void write_rows(const MaterialStack& stack, ByteSink& sink)
{
    const Imf::Header header = make_header(stack);
    SinkStream stream(sink);
    Imf::DeepScanLineOutputFile file(stream, header);
    Row row(header.dataWindow());
    file.setFrameBuffer(row.frame_buffer(true));
    for (int j = stack.size().y - 1; j >= 0; --j) {
        const auto for_each_sample = [&](int i, auto&& visit) {
            std::int32_t below = 0;
            for (const std::uint16_t word : stack.words(i, j)) {
                const std::int32_t top = MaterialStack::top_of(word);
                if (MaterialStack::material_of(word) != Material::air) visit(below, top, MaterialStack::material_of(word));
                below = top;
            }
        };
        for (int i = 0; i < stack.size().x; ++i) {
            unsigned& count = row.counts[static_cast<std::size_t>(i)] = 0;
            for_each_sample(i, [&](std::int32_t, std::int32_t, Material) { ++count; });
        }
        row.arrange();
        std::size_t at = 0;
        for (int i = 0; i < stack.size().x; ++i) {
            for_each_sample(i, [&](std::int32_t bottom, std::int32_t top, Material material) {
                row.z[at] = static_cast<float>(bottom * stack.unit());
                row.back[at] = static_cast<float>(top * stack.unit());
                row.material[at++] = static_cast<unsigned>(material);
            });
        }
        file.writePixels(1);
    }
}

bool same_words(const MaterialStack& a, const MaterialStack& b)
{
    if (a.size() != b.size() || a.cell() != b.cell() || a.unit() != b.unit() || a.origin() != b.origin()) return false;
    for (int j = 0; j < a.size().y; ++j) {
        for (int i = 0; i < a.size().x; ++i) {
            const auto x = a.words(i, j), y = b.words(i, j);
            if (!std::equal(x.begin(), x.end(), y.begin(), y.end())) return false;
        }
    }
    return true;
}

/// One file while it is being read. Everything thrown here says what is wrong without naming the file: read_stack_file does.
class Reader
{
public:
    Reader(const std::string& path, double bytes) : bytes_(bytes), file_(open(path)), row_(window()) {}

    std::shared_ptr<MaterialStack> read()
    {
        const Imath::Box2i box = window();
        check_header();
        stack_ = std::make_shared<MaterialStack>(Vec2i(box.max.x - box.min.x + 1, box.max.y - box.min.y + 1), number("hoodoo:cell"),
                                                 number("hoodoo:unit"), attribute<Imf::V3dAttribute>("hoodoo:origin").value());
        file_.setFrameBuffer(row_.frame_buffer(false));
        // Rows in bands that end where tiles do: each tile is packed once.
        std::vector<std::vector<Layer>> band;
        for (int j1 = stack_->size().y; j1 > 0;) {
            const int j0 = (j1 - 1) / MaterialStack::tile_size * MaterialStack::tile_size;
            band.assign(static_cast<std::size_t>(j1 - j0) * row_.counts.size(), {});
            for (int j = j1 - 1; j >= j0; --j) read_row(j, &band[static_cast<std::size_t>(j - j0) * row_.counts.size()]);
            stack_->set_columns({0, j0}, {stack_->size().x, j1}, band);
            j1 = j0;
        }
        return stack_;
    }

private:
    static Problem fault(std::string what, std::string expected = {}, std::string got = {})
    {
        return {{}, std::move(what), std::move(expected), std::move(got), {}};
    }
    [[noreturn]] static void refuse(Problem problem) { throw Error(ErrorKind::file, std::move(problem)); }
    [[noreturn]] static void refuse_column(int i, int j, const std::string& what, std::string expected = {}, std::string got = {})
    {
        refuse(fault(fmt::format("column ({}, {}): {}", i, j, what), std::move(expected), std::move(got)));
    }

    static Imf::DeepScanLineInputFile open(const std::string& path)
    {
        if (!Imf::isDeepOpenExrFile(path.c_str())) refuse(fault("it is no deep EXR"));
        return Imf::DeepScanLineInputFile(path.c_str(), 0);
    }

    const Imf::Header& header() const { return file_.header(); }

    Imath::Box2i window() const
    {
        const Imath::Box2i box = header().dataWindow();
        const double columns = (static_cast<double>(box.max.x) - box.min.x + 1) * (static_cast<double>(box.max.y) - box.min.y + 1);
        // Each column has at least a count of four bytes.
        if (!(columns >= 1.0 && columns <= max_columns && columns * sizeof(unsigned) <= max_expansion * bytes_))
            refuse(fault("its size", fmt::format("1 to {:.0f} columns, and no more than its {:.0f} bytes can hold", max_columns, bytes_),
                         fmt::format("{:.0f}", columns)));
        return box;
    }

    template <class Attribute>
    const Attribute& attribute(const char* name) const
    {
        const auto* found = header().findTypedAttribute<Attribute>(name);
        if (!found)
            refuse(fault(fmt::format("its header lacks {}", name),
                         "a file that hoodoo bake wrote: hoodoo:stack, hoodoo:cell, hoodoo:unit, hoodoo:origin, "
                         "hoodoo:materials"));
        return *found;
    }

    double number(const char* name) const
    {
        const double value = attribute<Imf::DoubleAttribute>(name).value();
        if (!(std::isfinite(value) && value > 0.0)) refuse(fault(name, "a positive length in metres", fmt::to_string(value)));
        return value;
    }

    void check_header()
    {
        if (const int version = attribute<Imf::IntAttribute>("hoodoo:stack").value(); version != format_version)
            refuse(fault("hoodoo:stack", fmt::to_string(format_version), fmt::to_string(version)));
        for (const auto& [name, type] : {std::pair("Z", Imf::FLOAT), {"ZBack", Imf::FLOAT}, {"material", Imf::UINT}}) {
            const Imf::Channel* channel = header().channels().findChannel(name);
            if (!channel || channel->type != type)
                refuse(fault("its channels", "Z and ZBack of floats, material of unsigned integers",
                             channel ? fmt::format("another type of {}", name) : fmt::format("no {}", name)));
        }
        for (const std::string& name : attribute<Imf::StringVectorAttribute>("hoodoo:materials").value()) {
            std::size_t m = 0;
            while (m < kMaterialCount && material_name(static_cast<Material>(m)) != name) ++m;
            if (m == kMaterialCount) refuse(fault("hoodoo:materials", "air, water, sand, bedrock, rock or soil", '"' + name + '"'));
            materials_.push_back(static_cast<Material>(m));
        }
    }

    void read_row(int j, std::vector<Layer>* columns)
    {
        const int y = window().min.y + stack_->size().y - 1 - j;
        try {
            file_.readPixelSampleCounts(y, y);
            check_counts(j);
            row_.arrange();
            file_.readPixels(y, y);
        } catch (const Error&) {
            throw;
        } catch (const std::exception& failure) {
            refuse(fault(fmt::format("columns (0, {}) to ({}, {}): {}", j, row_.counts.size() - 1, j, failure.what())));
        }
        std::size_t from = 0;
        for (std::size_t i = 0; i < row_.counts.size(); from += row_.counts[i++])
            columns[i] = layers_of(static_cast<int>(i), j, from, row_.counts[i]);
    }

    void check_counts(int j)
    {
        double total = 0.0;
        for (std::size_t i = 0; i < row_.counts.size(); ++i) {
            if (row_.counts[i] > static_cast<unsigned>(MaterialStack::max_top))
                refuse_column(static_cast<int>(i), j, "number of samples", fmt::format("at most {}", MaterialStack::max_top),
                              fmt::to_string(row_.counts[i]));
            total += row_.counts[i];
        }
        // Three channels of four bytes a sample.
        if (total * 12.0 > max_expansion * bytes_)
            refuse(
                fault(fmt::format("columns (0, {}) to ({}, {}): more samples than its {:.0f} bytes can hold", j, row_.counts.size() - 1, j, bytes_)));
    }

    std::vector<Layer> layers_of(int i, int j, std::size_t from, std::size_t count) const
    {
        std::vector<Layer> layers;
        std::int32_t previous_bottom = 0, previous_top = 0;
        for (std::size_t s = from; s < from + count; ++s) {
            const float z = row_.z[s], back = row_.back[s];
            const double bottom_units = std::round(z / stack_->unit()), top_units = std::round(back / stack_->unit());
            if (!(bottom_units >= 0.0 && top_units <= MaterialStack::max_top && z < back))
                refuse_column(i, j, "a sample", fmt::format("Z below ZBack, both from 0 to {:.6g} m", MaterialStack::max_top * stack_->unit()),
                              fmt::format("{} to {}", z, back));
            const std::int32_t bottom = static_cast<std::int32_t>(bottom_units), top = static_cast<std::int32_t>(top_units);
            if (bottom < previous_bottom || top < previous_top)
                refuse_column(i, j, "its samples are unordered", "samples from the bottom up",
                              fmt::format("{} to {} after a sample that ends at {:.6g}", z, back, previous_top * stack_->unit()));
            if (bottom < previous_top)
                refuse_column(i, j, "its samples overlap", fmt::format("a sample from {:.6g} m on", previous_top * stack_->unit()),
                              fmt::format("{} to {}", z, back));
            if (row_.material[s] >= materials_.size())
                refuse_column(i, j, "its material", fmt::format("less than {}", materials_.size()), fmt::to_string(row_.material[s]));
            if (bottom > previous_top) layers.push_back({Material::air, bottom});
            layers.push_back({materials_[row_.material[s]], top});
            previous_bottom = bottom;
            previous_top = top;
        }
        return layers;
    }

    double bytes_;
    Imf::DeepScanLineInputFile file_;
    Row row_;
    std::vector<Material> materials_;
    std::shared_ptr<MaterialStack> stack_;
};

}  // namespace

void write_stack_file(const std::string& path, const MaterialStack& stack)
{
    write_atomically(
        path, [&](ByteSink& sink) { write_rows(stack, sink); },
        [&](const std::string& temporary) {
            if (!same_words(stack, *read_stack_file(temporary, {}))) throw std::runtime_error("its columns differ");
        });
}

std::shared_ptr<MaterialStack> read_stack_file(const std::string& path, const Source& where)
{
    const auto refuse = [&](const Problem& why) {
        throw Error(ErrorKind::file, Problem{where, fmt::format("the stack \"{}\" cannot be read: {}", path, why.what), why.expected, why.got, {}});
    };
    std::error_code failed;
    const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
    if (failed || !std::filesystem::is_regular_file(path, failed)) refuse({{}, failed ? failed.message() : "it is no regular file", {}, {}, {}});
    try {
        return Reader(path, static_cast<double>(bytes)).read();
    } catch (const Error& error) {
        refuse(error.problems().front());
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) {
        refuse({{}, failure.what(), {}, {}, {}});
    }
    return nullptr;
}

}  // namespace hoodoo
