#include "pipeline/completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

namespace glint {
namespace {

using Kind = CompletionValue::Kind;

std::string Escaped(std::string_view text, std::string_view special) {
  std::string escaped;
  for (char c : text) {
    if (special.find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

// In single quotes, as bash and zsh read them.
std::string Quoted(std::string_view text) {
  std::string quoted = "'";
  for (char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

// Only the first sentence fits beside a completion.
std::string Brief(const std::string& help) { return help.substr(0, help.find(". ")); }

std::string BashReply(const CompletionValue& value) {
  switch (value.kind) {
    case Kind::kFile:
      return "_glint_files";
    case Kind::kChoice:
      return fmt::format("_glint_words {}", Quoted(fmt::format("{}", fmt::join(value.choices, " "))));
    case Kind::kPrefix:
      return fmt::format("_glint_words {}; compopt -o nospace 2>/dev/null",
                         Quoted(fmt::format("{}", fmt::join(value.choices, " "))));
    case Kind::kNone:
    case Kind::kOther:
      break;
  }
  return ":";
}

std::string ZshAction(const CompletionValue& value) {
  switch (value.kind) {
    case Kind::kNone:
      return "";
    case Kind::kFile:
      return ":file:_files";
    case Kind::kChoice:
      return fmt::format(":value:({})", fmt::join(value.choices, " "));
    case Kind::kPrefix:
      return fmt::format(":value:{{compadd -S \"\" -- {}}}", fmt::join(value.choices, " "));
    case Kind::kOther:
      return ":value: ";
  }
  return "";
}

std::string ZshFlag(const CompletionFlag& flag) {
  const std::string rest = Quoted(fmt::format("[{}]{}", Escaped(Brief(flag.help), "[]:\\"), ZshAction(flag.value)));
  std::vector<std::string> names = flag.names;
  if (flag.value.kind != Kind::kNone)
    for (std::string& name : names)
      if (name.starts_with("--")) name += "=";  // its value may follow it with = or with a space
  if (names.size() == 1) return Quoted("*" + names.front()) + rest;
  return fmt::format("'*'{{{}}}{}", fmt::join(names, ","), rest);
}

std::string FishValue(const CompletionValue& value) {
  switch (value.kind) {
    case Kind::kNone:
      return " -f";
    case Kind::kFile:
      return " -r -F";
    case Kind::kChoice:
    case Kind::kPrefix:
      return fmt::format(" -x -a \"{}\"", fmt::join(value.choices, " "));
    case Kind::kOther:
      return " -x";
  }
  return "";
}

std::string FishFlag(const CompletionFlag& flag) {
  std::string line;
  for (const std::string& name : flag.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  return line + FishValue(flag.value) + " -d '" + Escaped(Brief(flag.help), "'\\") + "'";
}

}  // namespace

std::string BashCompletion(const std::vector<CompletionCommand>& commands) {
  std::string names, values, flags, arguments;
  for (const CompletionCommand& command : commands) {
    names += command.name + " ";
    std::vector<std::string> all;
    for (const CompletionFlag& flag : command.flags) {
      all.insert(all.end(), flag.names.begin(), flag.names.end());
      if (flag.value.kind == Kind::kNone) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : flag.names) patterns.push_back(Quoted(command.name + " " + name));
      values += fmt::format("    {}) {}; return ;;\n", fmt::join(patterns, "|"), BashReply(flag.value));
    }
    flags +=
        fmt::format("      {}) _glint_words {} ;;\n", command.name, Quoted(fmt::format("{}", fmt::join(all, " "))));
    arguments += fmt::format("    {}) {} ;;\n", command.name, BashReply(command.argument));
  }
  return "# bash completion for glint; made by `glint completion bash`.\n"
         "_glint_words() { mapfile -t COMPREPLY < <(compgen -W \"$1\" -- \"$cur\"); }\n"
         "_glint_files() { mapfile -t COMPREPLY < <(compgen -f -- \"$cur\"); compopt -o filenames 2>/dev/null; }\n"
         "_glint() {\n"
         "  local cur=\"${COMP_WORDS[COMP_CWORD]}\" command=\"${COMP_WORDS[1]}\" "
         "before=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
         "  COMPREPLY=()\n"
         // --from=seed is three words to bash, and so is voxel_rel=0.01, which nothing completes.
         "  if [[ \"$cur\" == = ]]; then cur=; [[ \"$before\" == -* ]] || return\n"
         "  elif [[ \"$before\" == = ]]; then before=\"${COMP_WORDS[COMP_CWORD-2]}\"; [[ \"$before\" == -* ]] || "
         "return\n"
         "  fi\n"
         "  if ((COMP_CWORD == 1)); then _glint_words '" +
         names + "--help --version'; return; fi\n  case \"$command $before\" in\n" + values +
         "  esac\n  if [[ \"$cur\" == -* ]]; then\n    case \"$command\" in\n" + flags +
         "    esac\n    return\n  fi\n  case \"$command\" in\n" + arguments + "  esac\n}\ncomplete -F _glint glint\n";
}

std::string ZshCompletion(const std::vector<CompletionCommand>& commands) {
  std::string list, cases;
  for (const CompletionCommand& command : commands) {
    list += "    " + Quoted(command.name + ":" + Escaped(Brief(command.help), ":\\")) + "\n";
    cases += "    " + command.name + ")\n      _arguments";
    for (const CompletionFlag& flag : command.flags) cases += " \\\n        " + ZshFlag(flag);
    const std::string argument = ZshAction(command.argument);
    if (!argument.empty()) cases += " \\\n        " + Quoted("*" + argument);
    cases += " ;;\n";
  }
  return "#compdef glint\n# zsh completion for glint; made by `glint completion zsh`.\n_glint() {\n"
         "  local -a commands=(\n" +
         list +
         "  )\n  if ((CURRENT == 2)); then\n"
         "    if [[ $PREFIX == -* ]]; then compadd -- --help --version; else _describe command commands; fi\n"
         "    return\n  fi\n"
         "  local command=$words[2]\n  shift words\n  ((CURRENT--))\n  case $command in\n" +
         cases +
         "  esac\n}\n"
         "if [[ $funcstack[1] == _glint ]]; then _glint \"$@\"; else compdef _glint glint; fi\n";
}

std::string FishCompletion(const std::vector<CompletionCommand>& commands) {
  std::string script =
      "# fish completion for glint; made by `glint completion fish`.\ncomplete -c glint -f\n"
      "complete -c glint -n __fish_use_subcommand -l help -d 'Print help'\n"
      "complete -c glint -n __fish_use_subcommand -l version -d 'Print the version'\n";
  for (const CompletionCommand& command : commands) {
    script += fmt::format("complete -c glint -n __fish_use_subcommand -a {} -d '{}'\n", command.name,
                          Escaped(Brief(command.help), "'\\"));
    const std::string seen = fmt::format("complete -c glint -n '__fish_seen_subcommand_from {}'", command.name);
    for (const CompletionFlag& flag : command.flags) script += seen + FishFlag(flag) + "\n";
    if (command.argument.kind == Kind::kFile) script += seen + " -F\n";
    if (command.argument.kind == Kind::kChoice)
      script += fmt::format("{} -a \"{}\"\n", seen, fmt::join(command.argument.choices, " "));
  }
  return script;
}

}  // namespace glint
