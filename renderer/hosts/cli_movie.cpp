// `hoodoo movie`: numbered EXR files -> an H.264 film for the eye, through the display transform. ffmpeg encodes, called as a program: its pixels
// come through a pipe, no folder of intermediate pictures is left behind. The film appears under its name when ffprobe has counted its frames. Even
// sizes: 4:2:0 has half the colour samples, so an odd last row or column is cut.
#include "renderer/hosts/cli.h"

#include "renderer/film/write.h"
#include "renderer/scene/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>

#include <sys/wait.h>
#include <unistd.h>

namespace hoodoo::cli
{
namespace fs = std::filesystem;
namespace
{

/// A program with one end of a pipe in our hands: its input, or its output.
class Program
{
public:
    enum class End { input, output };

    Program(const std::vector<std::string>& words, End end) : name_(words.front())
    {
        std::vector<char*> argv;
        for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
        argv.push_back(nullptr);
        std::array<int, 2> pipe{};
        if (::pipe(pipe.data()) != 0) throw Error(ErrorKind::file, "no pipe can be opened");
        const int ours = end == End::input ? 1 : 0;
        child_ = ::fork();
        if (child_ == 0) {
            ::dup2(pipe[static_cast<std::size_t>(1 - ours)], 1 - ours);
            ::close(pipe[0]);
            ::close(pipe[1]);
            ::execvp(argv[0], argv.data());
            ::_exit(127);
        }
        ::close(pipe[static_cast<std::size_t>(1 - ours)]);
        descriptor_ = pipe[static_cast<std::size_t>(ours)];
        if (child_ < 0) throw Error(ErrorKind::memory, "no process can be started");
    }
    ~Program() { wait(); }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// Throws Error (file) if the program does not take it.
    void write(const std::vector<std::uint8_t>& bytes)
    {
        for (std::size_t done = 0; done < bytes.size();) {
            const ssize_t n = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) {
                finish();
                throw Error(ErrorKind::file, name_ + " takes no more pictures");
            }
            done += static_cast<std::size_t>(n);
        }
    }
    std::string read()
    {
        std::string text;
        char buffer[4096];
        for (ssize_t n = 0; (n = ::read(descriptor_, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(n));
        return text;
    }
    /// Throws Error (file) unless the program ends well.
    void finish()
    {
        const int code = wait();
        if (code == 127) throw Error(ErrorKind::file, name_ + " is not installed; Debian has it in the package ffmpeg");
        if (code != 0) throw Error(ErrorKind::file, fmt::format("{} failed (exit code {})", name_, code));
    }

private:
    int wait()
    {
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = -1;
        int status = 0;
        if (child_ > 0) ::waitpid(child_, &status, 0);
        child_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    }

    std::string name_;
    pid_t child_ = 0;
    int descriptor_ = -1;
};

/// All frames of that pattern which are on the disk, in order.
std::vector<std::int64_t> frames_on_disk(const std::string& pattern)
{
    const fs::path folder = fs::path(pattern).parent_path();
    std::vector<std::int64_t> frames;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, error)) {
        const std::string name = (folder / entry.path().filename()).string();
        // A frame's digits stand where the pattern has its place: the name of that frame must come out again.
        for (std::size_t begin = 0; begin < name.size(); ++begin) {
            if (!std::isdigit(static_cast<unsigned char>(name[begin]))) continue;
            const std::size_t end = std::min(name.find_first_not_of("0123456789", begin), name.size());
            if (end - begin > 9) break;
            const std::size_t sign = begin > 0 && name[begin - 1] == '-' ? 1 : 0;
            for (const std::size_t from : {begin - sign, begin}) {
                const std::int64_t frame = std::stoll(name.substr(from, end - from));
                if (frame_path(pattern, frame) == name && std::find(frames.begin(), frames.end(), frame) == frames.end()) frames.push_back(frame);
            }
            begin = end;
        }
    }
    std::sort(frames.begin(), frames.end());
    return frames;
}

double number_of(const Image& image, const std::string& name, double fallback)
{
    const auto found = image.metadata.find(name);
    const float* number = found == image.metadata.end() ? nullptr : std::get_if<float>(&found->second);
    return number ? static_cast<double>(*number) : fallback;
}

std::vector<std::string> encoder(const MovieArguments& arguments, const PixelBounds& size, double fps, const std::string& output)
{
    return {"ffmpeg",
            "-v",
            "error",
            "-y",
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
            "-s",
            fmt::format("{}x{}", size.width(), size.height()),
            "-r",
            fmt::to_string(fps),
            "-i",
            "-",
            "-an",
            "-c:v",
            "libx264",
            "-preset",
            "slow",
            "-crf",
            fmt::to_string(arguments.quality),
            "-pix_fmt",
            "yuv420p",
            "-vf",
            "crop=trunc(iw/2)*2:trunc(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
            "-color_primaries",
            "bt709",
            "-color_trc",
            "bt709",
            "-colorspace",
            "bt709",
            "-movflags",
            "+faststart",
            "-fflags",
            "+bitexact",
            "-flags:v",
            "+bitexact",
            "-f",
            "mp4",
            output};
}

/// Removes what was begun unless it is kept.
struct Aside {
    std::string path;
    ~Aside() { std::remove(path.c_str()); }
};

std::vector<std::int64_t> frames_of(const MovieArguments& arguments)
{
    if (!names_frames(arguments.input))
        throw Error(
            ErrorKind::scene,
            Problem{{}, "the pictures have no place for the frame in their name", "such as wave.####.exr", "\"" + arguments.input + "\"", {}});
    const std::vector<std::int64_t> frames = arguments.frames.empty() ? frames_on_disk(arguments.input) : parse_frames(arguments.frames);
    if (frames.empty()) throw Error(ErrorKind::file, fmt::format("there is no picture \"{}\"", arguments.input));
    return frames;
}

}  // namespace

int run_movie(const MovieArguments& arguments)
{
    check_output(arguments.output);
    const std::vector<std::int64_t> frames = frames_of(arguments);
    const Image first = read_exr(frame_path(arguments.input, frames.front()));
    const double fps = arguments.fps.value_or(number_of(first, "hoodoo:fps", 24.0));
    const double exposure = arguments.exposure.value_or(number_of(first, "hoodoo:exposure", 0.0));
    const ColorTransform to_display = ColorConfig::choose(arguments.colorconfig, {})->to_display(arguments.display, arguments.view, {});

    Progress progress(arguments.quiet);
    const Aside aside{arguments.output + ".part"};
    Program ffmpeg(encoder(arguments, first.data, fps, aside.path), Program::End::input);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const std::string name = frame_path(arguments.input, frames[k]);
        const Image image = read_exr(name);
        if (image.data.width() != first.data.width() || image.data.height() != first.data.height())
            throw Error(ErrorKind::file, fmt::format("the file \"{}\" has {} x {} pixels, the first picture {} x {}", name, image.data.width(),
                                                     image.data.height(), first.data.width(), first.data.height()));
        ffmpeg.write(display_bytes(image, to_display, exposure));
        progress.update(static_cast<double>(k + 1) / static_cast<double>(frames.size()), "movie");
    }
    progress.finish();
    ffmpeg.finish();

    // Count them before the film gets its name.
    Program ffprobe(
        {"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries", "stream=nb_read_frames", "-of", "csv=p=0", aside.path},
        Program::End::output);
    const std::string count = ffprobe.read();
    ffprobe.finish();
    if (std::strtoull(count.c_str(), nullptr, 10) != frames.size())
        throw Error(ErrorKind::file,
                    fmt::format("the film does not read back: {} frames of {}", std::strtoull(count.c_str(), nullptr, 10), frames.size()));
    fs::rename(aside.path, arguments.output);
    if (!arguments.quiet) fmt::print(stderr, "wrote {}: {} frames at {} a second\n", arguments.output, frames.size(), fps);
    return 0;
}

}  // namespace hoodoo::cli
