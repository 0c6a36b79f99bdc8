"""What only some systems have is asked for before it is used; files can be checked out and read on all systems."""

import ast
import re
import subprocess
from collections import Counter
from pathlib import Path, PurePosixPath

import pytest

ROOT = Path(__file__).parents[2]
#: modules that Windows or macOS does not have
_MODULES = {
    "fcntl",
    "resource",
    "termios",
    "pwd",
    "grp",
    "pty",
    "tty",
    "syslog",
    "readline",
    "curses",
    "msvcrt",
    "winreg",
}
#: attributes that Windows or macOS does not have, by module
_ATTRIBUTES = {
    "os": {
        *("fork", "forkpty", "getuid", "geteuid", "getgid", "getegid", "getloadavg", "sched_getaffinity"),
        *("unshare", "setns", "setsid", "getpgid", "killpg", "mkfifo", "mknod", "chown", "fchown", "lchown", "fchmod"),
        *("openpty", "uname", "sysconf", "nice", "wait", "wait3", "wait4", "WNOHANG", "memfd_create", "pidfd_open"),
        *("sendfile", "pread", "pwrite", "posix_fallocate", "posix_fadvise", "getrandom", "eventfd", "get_blocking"),
        *("O_NONBLOCK", "O_NOFOLLOW", "O_DIRECTORY", "O_CLOEXEC", "O_NOCTTY", "O_BINARY", "O_TMPFILE", "startfile"),
        "rename",  # fails on Windows if the new name exists, unlike os.replace
    },
    "signal": {
        *("SIGHUP", "SIGKILL", "SIGUSR1", "SIGUSR2", "SIGALRM", "SIGCHLD", "SIGPIPE", "SIGQUIT", "SIGCONT", "SIGSTOP"),
        *("SIGWINCH", "alarm", "setitimer", "pthread_kill", "pthread_sigmask", "sigwait", "CTRL_C_EVENT"),
    },
    "socket": {"AF_UNIX", "SO_REUSEPORT", "SO_BINDTODEVICE", "MSG_DONTWAIT", "MSG_NOSIGNAL", "send_fds", "recv_fds"},
    "select": {"poll", "epoll", "kqueue", "select"},  # select.select takes pipes and files on POSIX systems alone
    "time": {"tzset", "clock_gettime", "pthread_getcpuclockid"},
    "asyncio": {"start_unix_server", "open_unix_connection"},
}  # fmt: skip
_METHODS = {"add_signal_handler", "create_unix_server", "create_unix_connection", "connect_read_pipe"}
#: arguments of `subprocess` and `multiprocessing`
_ARGUMENTS = {"preexec_fn", "pass_fds", "process_group"}
#: what shows that the code has asked
_GUARD = re.compile(
    r"hasattr\(|getattr\(|sys\.platform|os\.name\b|platform\.system\(|\.is_dir\(|isdir\(|exists\(|S_ISSOCK\("
)
_CAUGHT = {"ImportError", "AttributeError", "OSError", "NotImplementedError", "Exception"}
#: used only where processes can be copied, as `morse.system.workers.can_fork` says
_COPIES = {"src/morse/many/forking.py"}
_WORDS = _MODULES.union(_METHODS, _ARGUMENTS, *_ATTRIBUTES.values(), ["get_context", "set_start_method"])
#: files without these words, most of them, need not be parsed
_SUSPECT = re.compile(rf"(?<!def )\b({'|'.join(_WORDS)})\b|['\"]/(proc|dev|etc|tmp|sys|var|usr)\b")
_PATHS = re.compile(r"'/(proc|dev|etc|tmp|sys|var|usr)(/|$)")


def unguarded(source: str) -> list[str]:
    """Uses of what some systems do not have, outside of a guard, as lines for a message."""
    if not _SUSPECT.search(source):
        return []
    tree = ast.parse(source)
    parents = {id(child): node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}
    faults = []
    for node in ast.walk(tree):
        use = _use(node)
        if use is not None and not _is_guarded(node, parents):
            faults.append(f"line {node.lineno}: {use}")  # type: ignore[attr-defined]
    return faults


def _use(node: ast.AST) -> str | None:
    if isinstance(node, ast.Import):
        return next((alias.name for alias in node.names if alias.name in _MODULES), None)
    if isinstance(node, ast.ImportFrom) and not node.level:
        names = [alias.name for alias in node.names if alias.name in _ATTRIBUTES.get(node.module or "", ())]
        return node.module if node.module in _MODULES else next(iter(names), None)
    if isinstance(node, ast.Attribute):
        owner = node.value.id.lstrip("_") if isinstance(node.value, ast.Name) else ""
        if node.attr in _METHODS or node.attr in _ATTRIBUTES.get(owner, ()):
            return ast.unparse(node)
    if isinstance(node, ast.keyword) and node.arg in _ARGUMENTS:
        node.lineno = node.value.lineno
        return node.arg
    if isinstance(node, ast.Call):
        name = _name(node)
        if name in ("open", "Path") and node.args and _PATHS.match(ast.unparse(node.args[0])):
            return ast.unparse(node)
        if name in ("get_context", "set_start_method") and "fork" in ast.unparse(node):
            return ast.unparse(node)
    return None


def _name(call: ast.Call) -> str:
    function = call.func
    return function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")


def _is_guarded(node: ast.AST, parents: dict[int, ast.AST]) -> bool:
    """Whether a condition or a handler of its function, or around its definition, concerns what the system has."""
    at: ast.AST | None = node
    while at is not None:
        above = parents.get(id(at))
        if isinstance(above, ast.Try) and at in above.body:
            caught = {
                name for handler in above.handlers for name in re.findall(r"\w+", ast.unparse(handler.type or at))
            }
            if caught & _CAUGHT:
                return True
        if isinstance(at, (ast.FunctionDef, ast.AsyncFunctionDef)) and _GUARD.search(ast.unparse(at)):
            return True
        if isinstance(above, (ast.If, ast.IfExp, ast.With)) and _GUARD.search(ast.unparse(above)):
            return True
        if isinstance(above, ast.With) and "suppress" in ast.unparse(above.items[0]):
            return True
        at = above
    return False


def undeclared(source: str) -> list[str]:
    """Texts that are read or written in the encoding of the system, as lines for a message."""
    faults = []
    for node in ast.walk(ast.parse(source)) if _TEXT.search(source) else ():
        if not isinstance(node, ast.Call) or _name(node) not in _TEXTS:
            continue
        words = {keyword.arg: keyword.value for keyword in node.keywords}
        if "encoding" in words or None in words:
            continue
        function = ast.unparse(node.func)
        owner, _, name = function.rpartition(".")
        place = {"open": int(owner in ("", "io", "codecs", "builtins")), "NamedTemporaryFile": 0, "fdopen": 1}.get(name)
        if name == "fdopen" or function == "open" or (name == "open" and not owner.endswith(_NO_TEXT)):
            mode = words.get("mode", node.args[place] if place is not None and len(node.args) > place else None)
            text = mode is None or (isinstance(mode, ast.Constant) and "b" not in str(mode.value))
        elif name in ("read_text", "write_text"):
            text = len(node.args) < 1 + (name == "write_text")
        elif name == "NamedTemporaryFile":
            mode = words.get("mode", node.args[0] if node.args else None)
            text = mode is not None and "b" not in ast.unparse(mode)
        else:
            text = owner == "subprocess" and bool({"text", "universal_newlines"} & words.keys())
        if text:
            faults.append(f"line {node.lineno}: {ast.unparse(node)[:80]}")
    return faults


#: functions that read and write texts, also those of `subprocess`
_TEXTS = {"open", "fdopen", "read_text", "write_text", "NamedTemporaryFile", "run", "Popen", "check_output", "call"}
_TEXT = re.compile(rf"\b({'|'.join(_TEXTS)})\(")
#: classes and objects whose method ``open`` opens no text
_NO_TEXT = (
    "Pillow",
    "_catalog",
    "Picture",
    "Image",
    "archive",
    "gzip",
    "zipfile",
    "tarfile",
    "wave",
    "webbrowser",
    "os",
    "output",
    "port",
)
_FILES = [
    ROOT / "hatch_build.py",
    *(path for place in ("src", "examples", "tools/release") for path in ROOT.glob(f"{place}/**/*.py")),
]


def test_nothing_is_used_that_the_system_may_not_have():
    faults = [
        f"{name}: {fault}"
        for path in sorted(_FILES)
        if (name := path.relative_to(ROOT).as_posix()) not in _COPIES
        for fault in unguarded(path.read_text("utf-8"))
    ]
    assert not faults, "ask first (hasattr, sys.platform, try):\n" + "\n".join(faults)


def test_texts_have_an_encoding():
    faults = [
        f"{path.relative_to(ROOT).as_posix()}: {fault}"
        for path in sorted(_FILES)
        for fault in undeclared(path.read_text("utf-8"))
    ]
    assert not faults, "the encoding of the system may be another one:\n" + "\n".join(faults)


@pytest.mark.parametrize(
    "source",
    [
        "import fcntl",
        "def f():\n    import resource",
        "import os\nos.fork()",
        "import os\ndef f(a, b):\n    os.rename(a, b)",
        "import signal\nx = signal.SIGHUP",
        "from signal import SIGKILL",
        "import subprocess\nsubprocess.Popen([], preexec_fn=print)",
        "import multiprocessing\nmultiprocessing.get_context('fork')",
        "open('/proc/self/status')",
        "import asyncio\nasyncio.get_running_loop().add_signal_handler(2, print)",
        "import select\nselect.select([], [], [])",
    ],
)
def test_unguarded_uses_are_seen(source: str):
    assert unguarded(source)


@pytest.mark.parametrize(
    "source",
    [
        "try:\n    import fcntl\nexcept ImportError:\n    fcntl = None",
        "import os\ndef f():\n    if not hasattr(os, 'fork'):\n        return 0\n    return os.fork()",
        "import sys, os\nif sys.platform != 'win32':\n    x = os.getuid()",
        "import os\nos.replace('a', 'b')",
        "import os\nn = len(os.sched_getaffinity(0)) if hasattr(os, 'sched_getaffinity') else 1",
    ],
)
def test_guarded_uses_pass(source: str):
    assert not unguarded(source)


@pytest.mark.parametrize(
    "source", ["open('a')", "open('a', 'w')", "path.read_text()", "path.write_text('x')", "path.open()", "io.open('a')"]
)
def test_texts_without_an_encoding_are_seen(source: str):
    assert undeclared(source)


@pytest.mark.parametrize(
    "source", ["open('a', 'rb')", "open('a', encoding='utf-8')", "path.read_text('utf-8')", "path.open('rb')"]
)
def test_texts_with_an_encoding_pass(source: str):
    assert not undeclared(source)


def test_files_can_be_checked_out_on_all_systems():
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, encoding="utf-8")
    if listed.returncode:
        pytest.skip("no checkout of git")
    names = listed.stdout.split("\0")[:-1]
    folders = {str(folder) for name in names for folder in PurePosixPath(name).parents}
    alike = [name for name, count in Counter(name.casefold() for name in {*names, *folders}).items() if count > 1]
    assert not alike, "names that differ by capitals alone"
    reserved = re.compile(r'[<>:"\\|?*\x00-\x1f]|[. ](/|$)|(^|/)(con|prn|aux|nul|com\d|lpt\d)(\.|/|$)', re.IGNORECASE)
    assert [name for name in names if reserved.search(name) or len(name) > 160] == []
    assert [name for name in names if (ROOT / name).is_symlink()] == []
