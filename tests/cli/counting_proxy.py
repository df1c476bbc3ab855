# SPDX-License-Identifier: GPL-3.0-or-later
"""A connection to a server on this machine that counts what comes back, and can break it off."""
import socket
import threading


class CountingProxy:
    """Forwards 127.0.0.1:`port` to 127.0.0.1:`server`."""

    def __init__(self, server):
        self.server = server
        self.bytes = 0        # from the server
        self.connections = 0
        self.cut_after = None  # bytes of a connection
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self):
        self.listener.close()

    def reset(self):
        self.bytes = self.connections = 0

    def _accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            self.connections += 1
            far = socket.create_connection(("127.0.0.1", self.server))
            ways = [threading.Thread(target=self._pass, args=(*ends, back), daemon=True)
                    for ends, back in (((client, far), False), ((far, client), True))]
            threading.Thread(target=self._join, args=(ways, client, far), daemon=True).start()

    @staticmethod
    def _join(ways, *ends):
        for way in ways:
            way.start()
        for way in ways:
            way.join()
        for end in ends:
            end.close()

    def _pass(self, source, sink, back):
        passed = 0
        try:
            while data := source.recv(65536):
                if back and self.cut_after is not None and passed + len(data) > self.cut_after:
                    sink.sendall(data[:max(self.cut_after - passed, 0)])
                    break
                sink.sendall(data)
                passed += len(data)
                if back:
                    self.bytes += len(data)
        except OSError:
            pass
        for end in (source, sink):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
