"""The command: wrong arguments are one sentence and exit 2; only loopback without a password."""

import asyncio
import logging
import signal
import socket
import subprocess
import sys
import threading

import pytest
from answering import wait_until_answers
from bokeh.server.views.ws import WSHandler
from tornado.websocket import WebSocketClosedError

from corpus_tools.core import InputError
from workbench.apps.options import Options, check_options, free_port, read_password
from workbench.apps.serving import _expect_closed_tabs


def workbench(*arguments):
    code = "from workbench.apps.main import run; run()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--app", "nonsense"), "nonsense"),
        (("/no/such/corpus",), "corpus.toml"),
        (("--host", "0.0.0.0"), "--password-file"),
        (("--port", "99999"), "99999"),
        (("--root", "/no/such/folder"), "--root"),
        (("--port", "22x"), "--port"),
        (("--password-file", "/no/such/file"), "/no/such/file"),
        (("--config", "/no/such/config.toml"), "/no/such/config.toml"),
    ],
)
def test_a_mistake_is_one_sentence_and_exit_2(arguments, word):
    done = workbench(*arguments)
    assert done.returncode == 2
    assert word in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1
    assert "Traceback" not in done.stderr
    assert not done.stdout  # it does not say that it serves, and then that it cannot


@pytest.mark.parametrize("told", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("answers", [False, True])
def test_it_stops_when_it_is_told_to_and_says_so(told, answers):
    """However early: as soon as it has said where it is, or when the page answers."""
    code = "from workbench.apps.main import run; run()"
    port = free_port()
    command = [sys.executable, "-c", code, "--no-browser", "--port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            assert "is at" in server.stdout.readline()
            if answers:
                wait_until_answers(f"http://127.0.0.1:{port}/static/js/bokeh.min.js")
            server.send_signal(told)
            out, err = server.communicate(timeout=60)
        finally:
            server.kill()  # a test that has failed waits for nobody
    assert server.returncode == 0
    assert "stopped" in out
    assert "Traceback" not in err


def test_a_tab_that_is_closed_while_something_is_sent_to_it_leaves_no_traceback(caplog):
    async def send(error):
        _expect_closed_tabs()
        loop = asyncio.get_running_loop()
        loop.call_exception_handler({"message": "never retrieved", "exception": error})

    def run(error):  # in a thread: a browser that other tests drive may have its loop in this one
        thread = threading.Thread(target=lambda: asyncio.run(send(error)))
        thread.start()
        thread.join()

    run(WebSocketClosedError())
    assert not caplog.records
    run(ValueError("another fault"))
    assert "another fault" in caplog.text


def test_bokeh_does_not_warn_of_a_tab_that_was_closed_in_the_middle(caplog):
    class Gone:
        async def send(self, connection):
            raise WebSocketClosedError

    _expect_closed_tabs()
    sending = threading.Thread(target=lambda: asyncio.run(WSHandler.send_message(None, Gone())))
    sending.start()
    sending.join()
    assert not caplog.records
    logging.getLogger("bokeh.server.views.ws").warning("another fault")
    assert "another fault" in caplog.text


def test_a_port_in_use_is_named():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=str(port)):
            check_options(Options(port=port))


def test_another_host_needs_password_origin_and_root(tmp_path):
    password = tmp_path / "password"
    password.write_text("long enough\n")
    with pytest.raises(InputError, match=r"--origin, --root"):
        check_options(Options(host="0.0.0.0", port=0, password_file=password))
    check_options(
        Options(host="0.0.0.0", port=0, password_file=password, origins=("lab:5006",), root=tmp_path)
    )


@pytest.mark.parametrize("text", ["", "short\n"])
def test_a_weak_password_is_refused(tmp_path, text):
    path = tmp_path / "password"
    path.write_text(text)
    with pytest.raises(InputError, match="8 characters"):
        read_password(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_password(tmp_path / "none")


def test_version():
    done = workbench("--version")
    assert done.returncode == 0
    assert done.stdout.startswith("workbench ")
