"""range_server.py FILE: serves a file by ranges of bytes at /WAY/NAME, each way right or wrong as its name says. Prints
its port, then a line for each request."""
import http.server
import socketserver
import sys
import threading
import time

data = open(sys.argv[1], "rb").read()
counts = {}


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def log_message(self, *_):
        pass

    def answer(self, status, headers, body, cut=0):
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body[:len(body) - cut])
        self.close_connection = self.close_connection or cut > 0

    def do_GET(self):
        way = self.path.split("/")[1]
        counts[way] = counts.get(way, 0) + 1
        number, wanted = counts[way], self.headers.get("Range")
        print(way, wanted, self.headers.get("If-Range"), flush=True)
        if way == "missing":
            return self.answer(404, {}, b"no such file")
        if way == "moved":
            return self.answer(302, {"Location": "/right/knot.fxs"}, b"")
        if way == "turning":
            return self.answer(302, {"Location": "/turning/knot.fxs"}, b"")
        if way == "headers":
            self.send_response(206)
            self.flush_headers()
            while True:
                self.wfile.write(b"X: " + 1000 * b"x" + b"\r\n")
        if way == "garbled":
            self.wfile.write(b"\x00\x01 this is no HTTP\r\n\r\n")
            self.close_connection = True
            return None
        if way == "silent":
            self.close_connection = True
            return None
        first, last = (int(text) for text in wanted.removeprefix("bytes=").split("-"))
        if way == "tiny":
            return self.answer(416, {"Content-Range": "bytes */9"}, b"")
        changed = way.startswith("change") and number > 6
        headers = {"Content-Range": f"bytes {first}-{last}/{len(data)}", "ETag": '"b"' if changed else '"a"'}
        if way in ("dated", "change-date"):
            del headers["ETag"]
            headers["Last-Modified"] = f"Mon, 0{2 if changed else 1} Nov 2026 10:00:00 GMT"
        if way == "whole" or (changed and way != "change-unsaid"):
            return self.answer(200, {}, data)
        body = data[first:last + 1]
        if way == "other":
            headers["Content-Range"] = f"bytes {first + 1}-{last + 1}/{len(data)}"
        if way == "unsaid":
            del headers["Content-Range"]
        if way == "longer":
            body += b"and more"
        if way == "slow":                                        # sends the body at two bytes per second
            self.send_response(206)
            for name, value in {**headers, "Content-Length": str(len(body))}.items():
                self.send_header(name, value)
            self.end_headers()
            for at in range(0, len(body), 2):
                self.wfile.write(body[at:at + 2])
                time.sleep(1)
            return None
        if way == "damaged" and number > 6:
            body = bytes(byte ^ 1 for byte in body)
        return self.answer(206, headers, body, len(body) // 2 if way == "early" and number > 6 else 0)


class Server(socketserver.ThreadingMixIn, http.server.HTTPServer):
    daemon_threads = True

    def handle_error(self, *_):
        pass


server = Server(("127.0.0.1", 0), Handler)
print(server.server_port, flush=True)
# The server stops when standard input ends.
threading.Thread(target=lambda: (sys.stdin.read(), server.shutdown())).start()
server.serve_forever()
