// knap new: a scenario to start from.
#include "app/commands.hpp"
#include "app/new_file.hpp"
#include "scenario/write_scenario.hpp"

#include <cstdio>

namespace knap {

ExitCode write_new_scenario(const std::string& name, bool force) {
    const std::filesystem::path given(name), file = given.extension() == ".toml" ? given : std::filesystem::path(name + ".toml");
    if (!force) refuse_existing(file);
    const std::string text = new_scenario(file.stem().string());
    read_scenario_text(text, file.string());  // a name that a scenario cannot have is refused here
    write_new_file(file, text);
    std::printf("wrote %s; next: knap check %s, knap run %s\n", file.string().c_str(), file.string().c_str(), file.string().c_str());
    return exit_done;
}

}  // namespace knap
