// The parts of the command line: what was asked, the commands, progress, signals.
#pragma once

#include "renderer/render.h"
#include "terrain/io/dem.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace hoodoo::cli
{

/// Exit codes: 0, those of ErrorKind, and 128 + the signal's number.
constexpr int exit_usage = 2;

/// What all commands that read a scene may say.
struct SceneArguments {
    std::string scene;
    SceneOverrides overrides;
    std::string colorconfig;
    int threads = 0;
    bool quiet = false;
};

struct RenderArguments {
    SceneArguments scene;
    std::vector<std::string> outputs;
    RenderOptions options;
    std::string frames;          ///< a range; empty: the one of scene.overrides.frame
    bool skip_existing = false;  ///< pictures that are there and whole stay
    bool dry_run = false;
};

struct MovieArguments {
    std::string input, output;  ///< EXR files with a place for the frame in their name; an MP4
    std::string frames;         ///< empty: all there are
    std::string colorconfig, display, view;
    std::optional<double> fps, exposure;  ///< without: what the first picture says
    int quality = 16;                     ///< constant rate factor of H.264: 0 lossless, 51 worst
    bool quiet = false;
};

struct ImportArguments {
    std::string input, output;
    DemOptions options;
    bool quiet = false;
};

/// Of one terrain of a scene to a file.
struct ExportArguments {
    SceneArguments scene;
    std::string terrain, output;
    double spacing = 0.0;                    ///< of a mesh, metres; 0: by default
    std::string crack_map, height, diagram;  ///< of cracked ground; empty: not wanted
    double cell = 0.0;                       ///< of these pictures, metres; 0: a 1024th of the longer side
};

/// Of one terrain looked at as a researcher does.
struct SurveyArguments {
    SceneArguments scene;  ///< for contours and hillshade an elevation model, too
    std::string terrain, output, mesh;
    std::vector<int> grid;                   ///< nodes along x, y, z
    std::vector<double> bounds;              ///< x0,x1,y0,y1 and perhaps z0,z1; empty: the terrain's
    std::vector<double> from, to, heights;   ///< of a section, metres; no heights: the terrain's
    int columns = 1200;                      ///< pixels along a section
    double cell = 0.0, scale = 1.0;          ///< metres between heights, 0: by default; metres for the value 1 of an elevation model
    double interval = 10.0;                  ///< metres between contours
    double azimuth = 5.497787143782138;      ///< radians from north to east
    double altitude = 0.7853981633974483;    ///< radians
    double exaggeration = 1.0, reach = 0.0;  ///< of heights; of the search for the surface beside a mesh, metres, 0: by default
    bool y_up = false;
};

/// Each returns the exit code and throws what it cannot do.
int run_render(const RenderArguments& arguments);
int run_check(const SceneArguments& arguments);
int run_info(const SceneArguments& arguments);
int run_schema(const std::string& section);
int run_version();
int run_import_dem(const ImportArguments& arguments);
int run_analyse(const ImportArguments& arguments);
int run_movie(const MovieArguments& arguments);
int run_bake(const ExportArguments& arguments);
int run_bake_cracks(const ExportArguments& arguments);
int run_mesh(const ExportArguments& arguments);
int run_sample(const SurveyArguments& arguments);
int run_section(const SurveyArguments& arguments);
int run_contours(const SurveyArguments& arguments);
int run_hillshade(const SurveyArguments& arguments);
int run_mesh_error(const SurveyArguments& arguments);

/// A bar with the time left on a terminal; elsewhere a plain line for each tenth. On stderr: stdout is for data.
class Progress
{
public:
    explicit Progress(bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// From any thread. A new `what` starts the clock anew.
    void update(double fraction, const std::string& what);
    /// Ends the line of the bar, so that other text may follow.
    void finish();

private:
    void draw(double fraction, double seconds) const;

    std::mutex mutex_;
    bool quiet_, terminal_;
    bool drawn_ = false;
    std::string what_;
    int shown_ = -1;  ///< tenths, or hundredths on a terminal
    std::chrono::steady_clock::time_point start_, last_;
};

/// Data, to stdout. Throws Error (file).
void print(const std::string& text);
LoadedScene load(const SceneArguments& arguments, Progress& progress);
/// Throws Error (file) if nothing can be written there: an hour of work must not end at a folder that does not exist.
void check_output(const std::string& path);

/// "1:05:20", "0:07".
std::string clock_text(double seconds);

/// SIGINT and SIGTERM. Before guard_render() a signal ends the program at once: nothing is being written then. After it, it sets the flag.
void catch_signals();
const std::atomic<bool>* guard_render();
/// 128 + the number of the signal that came, or 0.
int signal_exit_code();

}  // namespace hoodoo::cli
