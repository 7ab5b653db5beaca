// Serves the built files and passes everything else on to a running program: for work on the page, on this machine alone.
import { readFile } from "node:fs/promises";
import http from "node:http";
import net from "node:net";
import path from "node:path";

const types = { ".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8",
  ".svg": "image/svg+xml", ".txt": "text/plain; charset=utf-8" };
/** As the program has it, and images of style sheets (iX draws check marks with them). */
export const policy = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; " +
  "base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/** `address`: HOST:PORT; `program`: what `canopus run --web` prints. */
export async function serve(folder, address, program) {
  if (!program) throw new Error("--serve needs --program URL, as `canopus run --web` prints it");
  const target = new URL(program);
  const [host, port] = [address.slice(0, address.lastIndexOf(":")), Number(address.slice(address.lastIndexOf(":") + 1))];
  const headers_for = (headers) => ({ ...headers, host: target.host, ...(headers.origin ? { origin: target.origin } : {}) });

  const server = http.createServer(async (request, answer) => {
    const { pathname } = new URL(request.url, "http://page");
    const name = pathname === "/" ? "index.html" : pathname.slice(1);
    if (/^[\w.-]+$/.test(name) && types[path.extname(name)]) {
      try {
        const body = await readFile(path.join(folder, name));
        answer.writeHead(200, { "Content-Type": types[path.extname(name)], "Content-Security-Policy": policy, "Cache-Control": "no-store" });
        return answer.end(body);
      } catch {
        // The program may have it.
      }
    }
    const onward = http.request(new URL(request.url, target.origin), { method: request.method, headers: headers_for(request.headers) }, (reply) => {
      answer.writeHead(reply.statusCode ?? 502, reply.headers);
      reply.pipe(answer);
    });
    onward.on("error", (error) => {
      answer.writeHead(502, { "Content-Type": types[".txt"] });
      answer.end(`${target.origin}: ${error.message}\n`);
    });
    request.pipe(onward);
  });
  server.on("upgrade", (request, socket, head) => {
    const onward = net.connect(Number(target.port), target.hostname, () => {
      const headers = Object.entries(headers_for(request.headers)).map(([key, value]) => `${key}: ${value}`);
      onward.write(`${request.method} ${request.url} HTTP/1.1\r\n${headers.join("\r\n")}\r\n\r\n`);
      onward.write(head);
      onward.pipe(socket).pipe(onward);
    });
    for (const one of [onward, socket]) one.on("error", () => { onward.destroy(); socket.destroy(); });
  });
  await new Promise((done, failed) => server.on("error", failed).listen(port, host, done));
  console.log(`page on http://${host}:${server.address().port}/${target.hash}`);
}
