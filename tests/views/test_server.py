"""The live page's server: for this machine's browser alone, and quiet about readers who leave."""

import http.client
import socket
import struct
import threading

import pytest

import parflex as pf
from parflex.app import paper
from parflex.views.viewer.server import server_of


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    run = paper.run(0).result
    short = pf.Result(lambda: run.dataset.isel(time=slice(0, 3)), "")
    made = server_of(short.save(tmp_path_factory.mktemp("live") / "run.nc"), curves=False)
    thread = threading.Thread(target=made.serve_forever)
    thread.start()
    yield made
    made.shutdown()
    thread.join()
    made.server_close()


def answer(server, host: str | None, path: str = "/stamp") -> int:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=20)
    connection.putrequest("GET", path, skip_host=True)
    if host is not None:
        connection.putheader("Host", host)
    connection.endheaders()
    status = connection.getresponse().status
    connection.close()
    return status


def test_it_answers_by_its_own_names_alone(server):
    """A site that gives its name this machine's address (DNS rebinding) does not read the robot."""
    port = server.server_port
    assert {answer(server, f"{name}:{port}") for name in ("127.0.0.1", "localhost")} == {200}
    for host in (f"evil.example:{port}", "evil.example", f"127.0.0.1:{port + 1}", "127.0.0.1", "", None):
        assert answer(server, host) == 403
        assert answer(server, host, "/") == 403
    assert answer(server, f"localhost:{port}", "/nothing") == 404


def test_a_reader_who_leaves_is_not_told_of(server, capfd):
    """The page is far larger than what a socket holds: the connection is reset amid it."""
    for _ in range(3):
        reader = socket.create_connection(("127.0.0.1", server.server_port))
        reader.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        reader.sendall(f"GET / HTTP/1.1\r\nHost: localhost:{server.server_port}\r\n\r\n".encode())
        reader.recv(10)
        reader.close()
    assert answer(server, f"localhost:{server.server_port}") == 200
    out, err = capfd.readouterr()
    assert (out, err) == ("", "")
