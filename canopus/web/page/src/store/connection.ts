// The WebSocket to the run: events come in, views and commands go out (docs/web.md).
import { Commands } from "./commands.js";
import type { Hello, Reply, ServerEvent, ViewWish } from "./protocol.js";
import type { Store } from "./store.js";

const key_name = "canopus key";

/** The key of the printed address, kept for this tab; the address goes on without it. */
function key_of_address(): string {
  const found = /^#key=([0-9a-f]+)$/.exec(location.hash);
  if (found?.[1]) {
    sessionStorage.setItem(key_name, found[1]);
    history.replaceState(null, "", location.pathname + location.search);
  }
  return sessionStorage.getItem(key_name) ?? "";
}

export class Connection {
  readonly commands: Commands;
  private socket: WebSocket | null = null;
  private key = key_of_address();
  private wishes = "[]";
  private wish_timer: ReturnType<typeof setTimeout> | null = null;
  private wanted: readonly ViewWish[] = [];

  constructor(private readonly store: Store) {
    this.commands = new Commands((message) => {
      if (this.socket?.readyState !== WebSocket.OPEN) return false;
      this.socket.send(JSON.stringify(message));
      return true;
    });
    setInterval(() => { if (!document.hidden) store.look_at_clock(performance.now()); }, 500);
    void this.connect();
  }

  /** What is looked at beside the state, said to the server at most ten times a second. */
  look_at(wanted: readonly ViewWish[]): void {
    this.wanted = wanted.slice(0, 8);
    if (this.wish_timer !== null) return;
    this.wish_timer = setTimeout(() => {
      this.wish_timer = null;
      const text = JSON.stringify(this.wanted);
      if (text === this.wishes || this.socket?.readyState !== WebSocket.OPEN) return;
      this.wishes = text;
      this.socket.send(`{"views":${text}}`);
    }, 100);
  }

  private async connect(): Promise<void> {
    if (document.querySelector("meta[name=canopus-users]")) await this.ask_session();
    const socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/events${this.key ? `?key=${this.key}` : ""}`);
    this.socket = socket;
    socket.addEventListener("open", () => {
      this.wishes = "[]";
      this.store.opened(performance.now());
      this.look_at(this.wanted);
      void this.greet();
    });
    socket.addEventListener("message", (message) => {
      const list = JSON.parse(message.data as string) as ServerEvent[];
      this.store.receive(list, performance.now());
      for (const event of list) if (event.event === "reply") this.commands.received(event as Reply);
    });
    socket.addEventListener("close", () => {
      this.commands.lost();
      this.store.closed();
      setTimeout(() => void this.connect(), 2000);
    });
  }

  private async greet(): Promise<void> {
    const hello = await this.commands.run({ command: "hello" });
    if (hello.code === 0) this.store.greeted(hello as unknown as Hello, performance.now());
  }

  /** With users: what the session's WebSocket has to say; a page whose session is over goes to log in. */
  private async ask_session(): Promise<void> {
    try {
      const answer = await fetch("session");
      if (answer.status === 401) location.assign("login");
      if (answer.ok) this.key = ((await answer.json()) as { key: string }).key;
    } catch {
      // The server does not answer; the WebSocket will not, either, and tries again.
    }
  }

  async log_out(): Promise<void> {
    await fetch("logout", { method: "POST", body: new URLSearchParams({ key: this.key }) }).catch(() => undefined);
    location.assign("login");
  }
}
