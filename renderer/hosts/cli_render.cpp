// `hoodoo render`: one picture or the frames of an animation, one after the other. Each file is whole or not there, so that a stopped run goes on
// with
// --skip-existing where it was; a frame depends on nothing but its number, so that one made alone has the same bits.
#include "renderer/hosts/cli.h"

#include "renderer/scene/frames.h"
#include "renderer/scene/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace hoodoo::cli
{
namespace
{

/// A small picture first: its time a sample, times the samples of the whole.
int estimate(const LoadedScene& loaded, const RenderArguments& arguments, std::size_t frames)
{
    const FilmLayout size = picture_layout(loaded.description, arguments.options);
    RenderOptions probe = arguments.options;
    probe.quick = false;
    probe.progress = {};
    probe.crop_window.reset();
    probe.pixel_bounds.reset();
    probe.replicates = 1;
    probe.width = std::clamp(size.width / 8, 1, 128);
    probe.height = std::clamp(size.height / 8, 1, 128);
    probe.spp = 2;
    const auto start = std::chrono::steady_clock::now();
    render(loaded, probe);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double pixels = static_cast<double>(size.data.width()) * size.data.height();
    std::uint64_t bytes = 0;
    for (const SceneObject& object : loaded.scene->objects()) bytes += object.info.stack_bytes + object.info.trace_bytes;
    const double all = seconds * pixels * size.samples / (2.0 * *probe.width * *probe.height);
    print(fmt::format("{} x {} pixels, {} samples each: about {:.0f} s, film about {:.0f} MB, terrain {:.0f} MB\n", size.width, size.height,
                      size.samples, all, pixels * 200e-6, static_cast<double>(bytes) * 1e-6));
    if (frames > 1) print(fmt::format("{} frames like it: about {}\n", frames, clock_text(all * static_cast<double>(frames))));
    return 0;
}

/// The frames asked for, each once. Without a range: the scene's own.
std::vector<std::optional<std::int64_t>> frames_of(const RenderArguments& arguments)
{
    if (arguments.frames.empty()) return {arguments.scene.overrides.frame};
    std::vector<std::optional<std::int64_t>> frames;
    for (const std::int64_t frame : parse_frames(arguments.frames)) frames.emplace_back(frame);
    if (frames.size() > 1)
        for (const std::string& output : arguments.outputs)
            if (!names_frames(output))
                throw Error(ErrorKind::scene,
                            Problem{{}, "all frames would have one name", "a place for the frame, such as wave.####.exr", "\"" + output + "\"", {}});
    return frames;
}

/// Takes the frames in turn.
class Animation
{
public:
    Animation(const RenderArguments& arguments, std::size_t count) : arguments_(arguments), progress_(arguments.scene.quiet), count_(count) {}

    /// Returns the exit code.
    int render_one(const std::optional<std::int64_t>& frame)
    {
        SceneArguments scene = arguments_.scene;
        scene.overrides.frame = frame;
        const Description description = read_scene(scene.scene, false, scene.overrides);
        std::vector<std::string> outputs;
        for (const std::string& output : arguments_.outputs) outputs.push_back(frame_path(output, description.frame));
        for (const std::string& output : outputs) check_output(output);
        ++number_;
        if (arguments_.skip_existing && exist(outputs, description)) {
            say(fmt::format("{} {} there already", fmt::join(outputs, ", "), outputs.size() > 1 ? "are" : "is"));
            return 0;
        }
        const auto start = std::chrono::steady_clock::now();
        const LoadedScene loaded = load(scene, progress_);
        picture_layout(loaded.description, arguments_.options);
        RenderOptions options = arguments_.options;
        options.cancel = guard_render();
        if (arguments_.dry_run) {
            progress_.finish();
            return estimate(loaded, arguments_, count_);
        }
        const std::string label = count_ > 1 ? fmt::format("frame {} ({} of {}{})", description.frame, number_, count_, time_left()) : "tracing";
        options.progress = [&](double fraction, const std::string&) { progress_.update(fraction, label); };
        const Image image = render(loaded, options);
        progress_.finish();
        if (const int code = signal_exit_code()) {
            say(count_ > 1 ? fmt::format("stopped in frame {}; {} frames were written", description.frame, rendered_)
                           : "stopped; nothing was written");
            return code;
        }
        for (const std::string& output : outputs) {
            write_picture(image, output, loaded);
            say("wrote " + output);
        }
        ++rendered_;
        spent_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return signal_exit_code();
    }

private:
    bool exist(const std::vector<std::string>& outputs, const Description& description) const
    {
        const std::string key = picture_key(description, arguments_.options);
        return std::all_of(outputs.begin(), outputs.end(), [&](const std::string& output) { return is_rendered(output, key); });
    }

    /// Of all frames to come, at the mean of those that were rendered.
    std::string time_left() const
    {
        return rendered_ ? fmt::format(", {} left in all", clock_text(spent_ / rendered_ * static_cast<double>(count_ - number_ + 1))) : "";
    }

    void say(const std::string& text) const
    {
        if (!arguments_.scene.quiet) fmt::print(stderr, "{}\n", text);
    }

    const RenderArguments& arguments_;
    Progress progress_;
    std::size_t count_, number_ = 0;
    int rendered_ = 0;
    double spent_ = 0.0;
};

}  // namespace

int run_render(const RenderArguments& arguments)
{
    for (const std::string& output : arguments.outputs) check_output(output);
    const std::vector<std::optional<std::int64_t>> frames = frames_of(arguments);
    Animation animation(arguments, frames.size());
    for (const std::optional<std::int64_t>& frame : frames) {
        if (const int code = animation.render_one(frame)) return code;
        if (arguments.dry_run) break;
    }
    return 0;
}

}  // namespace hoodoo::cli
