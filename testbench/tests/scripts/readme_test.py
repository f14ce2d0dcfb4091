"""Holds README.md and the pages that it leads to to the program: what they name exists, and together they name every command and option.
The page of all parameters and figures is what the program prints.

Usage: readme_test.py RTUSIM SOURCE

Code is what stands in backticks or is indented by four. An option belongs to the command that its code begins with, else to those that its
paragraph or table names. The keys of `--set` and `explain` are known ones, and a path from the top of the tree leads to something.
"""

import re
import subprocess
import sys
from pathlib import Path

program, source = sys.argv[1], Path(sys.argv[2])
PAGES = ("README.md", "scenes/README.md", "testbench/pictures/README.md", "testbench/sweeps/README.md", "waveforms/README.md")
REFERENCE = "testbench/commands/REFERENCE.md"
TOP = ("cmake", "modules", "scenes", "scripts", "testbench", "waveforms")
OPTION = re.compile(r"-(?:[a-z]|-[a-z][a-z-]*)$")
faults = []


def told(*arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=False)


def options_of(*command):
    """The options that the help of a command lists."""
    names = set()
    for found in re.findall(r"^  (-\S+)", told(*command, "--help").stdout, re.M):
        names.update(found.split(","))
    return names


COMMANDS = re.findall(r"^  (\w+)  ", told("--help").stdout.partition("Subcommands:")[2], re.M)
OPTIONS = {command: options_of(command) for command in COMMANDS}
OWN = options_of()
SCRIPTS = "".join(path.read_text() for path in sorted((source / "scripts").iterdir()))


def codes_of(block):
    """Pieces of code of a paragraph, table or indented text, without the comments of a shell."""
    indented = re.findall(r"^    (.*)$", re.sub(r"\\\n", " ", block), re.M) if block.startswith("    ") else []
    return re.findall(r"`([^`]+)`", block) + [re.sub(r"  +#.*| # .*", "", line) for line in indented]


def named(code):
    """The command that a piece of code begins with, whether it says whose, and its other words."""
    words = [word.strip("[],;:.") for word in code.split()]
    after = next((i for i, word in enumerate(words) if re.fullmatch(r"(.*/)?rtusim", word)), -1)
    if after + 1 < len(words) and words[after + 1] in COMMANDS:
        return words[after + 1], after >= 0, words[after + 2:]
    return None, after >= 0, words[after + 1:]


def check_keys(words, where):
    for before, word in zip(words, words[1:]):
        key = word.partition("=")[0]
        if before == "--set" and not key.isupper() and "NAME" not in key and told("explain", key).returncode != 0:
            faults.append(f"{where}: --set {key}: no such key")


def check_code(page, text):
    """The options that are told of each command."""
    seen = {command: set() for command in COMMANDS}
    for block in re.split(r"\n\s*\n", text):
        codes = [(code, *named(code)) for code in codes_of(block)]
        about = {command for _, command, _, _ in codes if command}
        for code, command, of_program, words in codes:
            options = {word.partition("=")[0] for word in words if OPTION.match(word.partition("=")[0])}
            where = f"{page}: {code.strip()}"
            check_keys(words, where)
            if command:
                seen[command] |= {command} | options
                if command == "explain" and words and not words[0].isupper() and told("explain", words[0]).returncode != 0:
                    faults.append(f"{where}: nothing to explain")
                faults.extend(f"{where}: no option {o} of {command}" for o in sorted(options - OPTIONS[command]))
            elif of_program:
                if words and not OPTION.match(words[0]):
                    faults.append(f"{where}: no command {words[0]}")
                else:
                    faults.extend(f"{where}: no option {o}" for o in sorted(options - OWN))
            elif words and OPTION.match(words[0].partition("=")[0]):
                for c in about:
                    seen[c] |= options
                known = set().union(*OPTIONS.values(), OWN)
                faults.extend(f"{where}: no option {o} of any command or script" for o in sorted(options - known) if o not in SCRIPTS)
    return seen


def check_paths(page, text):
    links = re.findall(r"\]\(([^)#:]+)\)", text)
    words = [word.strip("[](),;:") for block in re.split(r"\n\s*\n", text) for code in codes_of(block) for word in code.split()]
    paths = {(source / page).parent / link for link in links}
    paths |= {source / word.rstrip(".") for word in words if "/" in word and word.split("/")[0] in TOP}
    faults.extend(f"{page}: {path}: no such file" for path in sorted(paths) if not path.exists())
    return len(paths)


seen, paths = {command: set() for command in COMMANDS}, 0
for page in PAGES:
    text = (source / page).read_text()
    for command, options in check_code(page, text).items():
        seen[command] |= options
    paths += check_paths(page, text)
    if page != "README.md" and f"]({page})" not in (source / "README.md").read_text():
        faults.append(f"README.md: does not lead to {page}")
for command in COMMANDS:
    if command not in seen[command]:
        faults.append(f"README.md: no word of rtusim {command}")
    faults.extend(f"{', '.join(PAGES)}: no word of rtusim {command} {o}" for o in sorted(OPTIONS[command] - seen[command] - {"-h", "--help"}))
if (source / REFERENCE).read_text() != told("explain", "--markdown").stdout:
    faults.append(f"{REFERENCE}: not what `rtusim explain --markdown` prints; expected it to be written anew")
if len(COMMANDS) < 8 or paths < 20:
    faults.append(f"{len(COMMANDS)} commands and {paths} paths; expected more, so they are not found here as they are written")
print("\n".join(faults) or f"{sum(len(seen[c] & OPTIONS[c]) for c in COMMANDS)} options of {len(COMMANDS)} commands, {paths} paths")
sys.exit(1 if faults else 0)
