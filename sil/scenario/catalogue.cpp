#include "sil/scenario/catalogue.h"

#include <algorithm>
#include <optional>

#include "sil/scenario/document.h"
#include "sil/scenario/table_reader.h"

#ifndef STEADYSTEP_SIL_SOURCE_DIR
#error "STEADYSTEP_SIL_SOURCE_DIR: folder that holds scenarios/ and motors/"
#endif

namespace scenario
{

namespace fs = std::filesystem;

bool is_path(const std::string &name)
{
    return name.find('/') != std::string::npos || fs::path(name).extension() == ".toml";
}

namespace
{

std::vector<fs::path> toml_files(const fs::path &folder)
{
    std::vector<fs::path> files;
    std::error_code error;
    for (const fs::directory_entry &entry : fs::directory_iterator(folder, error)) {
        if (entry.path().extension() == ".toml") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end(),
              [](const fs::path &a, const fs::path &b) { return a.stem() < b.stem(); });
    return files;
}

/* "motor/law" of a parameter set. */
std::string set_name(const fs::path &file)
{
    return (file.parent_path().filename() / file.stem()).string();
}

[[noreturn]] void refuse_name(const char *what, const std::string &name,
                              const std::string &asked_by, const std::vector<std::string> &known)
{
    const std::string guess = nearest(name, known);
    throw InputError(asked_by + ": unknown " + what + " \"" + name + "\", expected a path or " +
                     (guess.empty() ? "a name that `steadystep-sil list` shows"
                                    : "a known name (did you mean " + guess + "?)"));
}

/* The file of `name` in the first folder that has it. */
std::optional<fs::path> file_of(const std::string &name, const std::vector<fs::path> &folders)
{
    std::error_code error;
    for (const fs::path &folder : folders) {
        const fs::path file = folder / (name + ".toml");
        if (fs::is_regular_file(file, error)) {
            return file;
        }
    }
    return {};
}

fs::path look_up(const char *what, const std::string &name, const std::string &asked_by,
                 const std::vector<fs::path> &folders)
{
    if (const std::optional<fs::path> file = file_of(name, folders)) {
        return *file;
    }
    std::vector<std::string> known;
    for (const fs::path &folder : folders) {
        for (const fs::path &file : toml_files(folder)) {
            known.push_back(file.stem().string());
        }
    }
    refuse_name(what, name, asked_by, known);
}

} // namespace

Catalogue::Catalogue(const fs::path &scenarios, const fs::path &program)
{
    const fs::path source = STEADYSTEP_SIL_SOURCE_DIR;
    const fs::path beside = program.parent_path();
    std::error_code error;
    const bool installed = fs::is_directory(beside / "scenarios", error);

    scenarios_ = !scenarios.empty() ? scenarios
                 : installed        ? beside / "scenarios"
                                    : source / "scenarios";
    if (!fs::is_directory(scenarios_, error)) {
        throw InputError(scenarios_.string() + ": no such folder of scenarios");
    }
    const auto folders = [&](const char *name) -> std::vector<fs::path> {
        const fs::path own = (installed ? beside : source) / name;
        const fs::path theirs = scenarios_ / ".." / name;
        return fs::equivalent(theirs, own, error) ? std::vector<fs::path>{own}
                                                  : std::vector<fs::path>{theirs, own};
    };
    motors_ = folders("motors");
    parameters_ = folders("parameters");
}

fs::path Catalogue::scenario(const std::string &name, const std::string &asked_by,
                             const fs::path &folder) const
{
    return is_path(name) ? folder / name : look_up("scenario", name, asked_by, {scenarios_});
}

fs::path Catalogue::sweep(const std::string &name, const std::string &asked_by) const
{
    return is_path(name) ? fs::path(name)
                         : look_up("sweep", name, asked_by, {scenarios_ / "sweeps"});
}

fs::path Catalogue::motor(const std::string &name, const std::string &asked_by,
                          const fs::path &folder) const
{
    return is_path(name) ? folder / name : look_up("motor", name, asked_by, motors_);
}

fs::path Catalogue::parameters(const std::string &name, const std::string &asked_by,
                               const fs::path &folder) const
{
    if (fs::path(name).extension() == ".toml") {
        return folder / name;
    }
    const std::optional<fs::path> file = file_of(name, parameters_);
    if (file && set_name(*file) == name) {
        return *file;
    }
    std::vector<std::string> known;
    for (const fs::path &other : parameters()) {
        known.push_back(set_name(other));
    }
    refuse_name("parameter set", name, asked_by, known);
}

std::vector<fs::path> Catalogue::scenarios() const
{
    return toml_files(scenarios_);
}

std::vector<fs::path> Catalogue::sweeps() const
{
    return toml_files(scenarios_ / "sweeps");
}

std::vector<fs::path> Catalogue::motors() const
{
    std::vector<fs::path> files;
    for (const fs::path &folder : motors_) {
        const std::vector<fs::path> more = toml_files(folder);
        files.insert(files.end(), more.begin(), more.end());
    }
    return files;
}

std::vector<fs::path> Catalogue::parameters() const
{
    std::vector<fs::path> files;
    for (const fs::path &folder : parameters_) {
        std::vector<fs::path> motors;
        std::error_code error;
        for (const fs::directory_entry &entry : fs::directory_iterator(folder, error)) {
            motors.push_back(entry.path());
        }
        std::sort(motors.begin(), motors.end());
        for (const fs::path &motor : motors) {
            const std::vector<fs::path> sets = toml_files(motor);
            files.insert(files.end(), sets.begin(), sets.end());
        }
    }
    return files;
}

} // namespace scenario
