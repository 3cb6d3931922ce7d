// A dense grid of samples as an OpenVDB file, negative inside as level sets are. Its class is left open: the numbers are the field's own, no
// distances.
#include "terrain/io/grid_file.h"

#include "terrain/error.h"

#ifdef HOODOO_OPENVDB

#include "terrain/io/atomic_file.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <sstream>

namespace hoodoo
{

void write_vdb_grid(const std::string& path, const SampledGrid& grid)
{
    openvdb::initialize();
    // Beyond the samples there is air.
    const double largest = grid.values.empty() ? 1.0 : *std::max_element(grid.values.begin(), grid.values.end());
    const auto volume = openvdb::FloatGrid::create(largest > 0.0 ? static_cast<float>(largest) : 1.0f);
    volume->setName("field");
    openvdb::Mat4d frame = openvdb::Mat4d::identity();
    frame.postScale(openvdb::Vec3d(grid.step.x, grid.step.y, grid.step.z));
    frame.setTranslation(openvdb::Vec3d(grid.origin.x, grid.origin.y, grid.origin.z));
    volume->setTransform(openvdb::math::Transform::createLinearTransform(frame));
    auto accessor = volume->getAccessor();
    std::size_t next = 0;
    for (int i = 0; i < grid.count[0]; ++i)
        for (int j = 0; j < grid.count[1]; ++j)
            for (int k = 0; k < grid.count[2]; ++k) accessor.setValue({i, j, k}, static_cast<float>(grid.values[next++]));
    std::ostringstream bytes(std::ios::binary);
    openvdb::io::Stream(bytes).write(openvdb::GridCPtrVec{volume});
    // A stream has no table of contents, which OpenVDB's readers do without: they read it whole.
    const std::string text = bytes.str();
    write_atomically(
        path, [&](ByteSink& sink) { sink.write(text.data(), text.size()); }, [](const std::string&) {});
}

}  // namespace hoodoo

#else

namespace hoodoo
{

void write_vdb_grid(const std::string&, const SampledGrid&)
{
    throw Error(ErrorKind::internal, "this build has no OpenVDB: .vdb cannot be written");
}

}  // namespace hoodoo

#endif
