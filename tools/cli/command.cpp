#include "tools/cli/command.hpp"

#include <cstdint>
#include <filesystem>

#include <CLI/CLI.hpp>

namespace slamd::cli {

Option Option::required() const { return Option(option_->required()); }

Option Option::shows_default() const { return Option(option_->capture_default_str()); }

Option Option::shows_default(const std::string& text) const { return Option(option_->default_str(text)); }

Option Option::value_name(const std::string& name) const { return Option(option_->type_name(name)); }

Option Option::unlabelled() const { return Option(option_->option_text(" ")); }

Option Option::within(double least, double most) const { return Option(option_->check(CLI::Range(least, most))); }

Option Option::within(int least, int most) const { return Option(option_->check(CLI::Range(least, most))); }

Option Option::zero_or_within(double least, double most) const {
  return Option(option_->check(CLI::Range(least, most) | CLI::IsMember({"0"})));
}

Option Option::positive() const { return Option(option_->check(CLI::PositiveNumber)); }

Option Option::one_of(const std::vector<std::string>& values) const { return Option(option_->check(CLI::IsMember(values))); }

Option Option::existing_file() const { return Option(option_->check(CLI::ExistingFile)); }

Option Option::excludes(std::initializer_list<const char*> names) const {
  for (const char* name : names) {
    option_->excludes(std::string(name));
  }
  return *this;
}

Option Option::needs(const Option& other) const { return Option(option_->needs(other.option_)); }

Option Option::take_all() const { return Option(option_->take_all()); }

Option Option::commas(int count) const { return Option(option_->delimiter(',')->expected(count)); }

Command Command::under(const std::string& heading) const {
  Command command(app_);
  command.heading_ = heading;
  return command;
}

Option Command::listed(CLI::Option* option) const { return Option(heading_.empty() ? option : option->group(heading_)); }

template <typename T>
Option Command::option(const std::string& name, T& value, const std::string& help) const {
  return listed(app_->add_option(name, value, help));
}

template Option Command::option(const std::string&, std::string&, const std::string&) const;
template Option Command::option(const std::string&, int&, const std::string&) const;
template Option Command::option(const std::string&, double&, const std::string&) const;
template Option Command::option(const std::string&, float&, const std::string&) const;
template Option Command::option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Command::option(const std::string&, std::filesystem::path&, const std::string&) const;
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Command::option(const std::string&, std::vector<int>&, const std::string&) const;
template Option Command::option(const std::string&, std::vector<double>&, const std::string&) const;
template Option Command::option(const std::string&, std::vector<std::uint16_t>&, const std::string&) const;
template Option Command::option(const std::string&, std::vector<std::uint64_t>&, const std::string&) const;

Option Command::flag(const std::string& name, bool& value, const std::string& help) const {
  return listed(app_->add_flag(name, value, help));
}

Option Command::action(const std::string& name, const std::function<void()>& act, const std::string& help) const {
  return listed(app_->add_flag_callback(name, act, help)->trigger_on_parse());
}

Command Command::command(const std::string& name, const std::string& help) const { return Command(app_->add_subcommand(name, help)); }

void Command::require_command() const { app_->require_subcommand(1); }

void Command::takes_outer_options() const { app_->fallthrough(); }

void Command::when_given(const std::function<void()>& act) const { app_->callback(act); }

void Command::footer(const std::string& text) const { app_->footer(text); }

bool Command::is_given() const { return app_->parsed(); }

std::string Command::given_command() const { return app_->get_subcommands().front()->get_name(); }

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_version_flag("--version", name + " " + version);
  app_->get_formatter()->column_width(34);
}

CommandLine::~CommandLine() = default;

Command CommandLine::program() const { return Command(app_.get()); }

std::optional<int> CommandLine::read(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::CallForHelp& call) {
    return app_->exit(call);
  } catch (const CLI::CallForVersion& call) {
    return app_->exit(call);
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + " (try --help)");
  }
  return std::nullopt;
}

}  // namespace slamd::cli
