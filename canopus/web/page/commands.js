// What people have done: commands to the server and their replies (docs/web.md).

const key_name = "canopus key";

/// The key of the printed address, kept for this tab; the address goes on without it.
export function take_key() {
  const found = location.hash.match(/^#key=([0-9a-f]+)$/);
  if (found) {
    sessionStorage.setItem(key_name, found[1]);
    history.replaceState(null, "", location.pathname + location.search);
  }
  return sessionStorage.getItem(key_name) ?? "";
}

export class Commands {
  /// `send`: takes a message for the server; false when there is none.
  constructor(send) {
    this.send = send;
    this.next = 1;
    this.waiting = new Map();  // by number: { resolve, rows, told }
  }

  /// Resolves to { code, rows, message, command, file }, never rejects; `told` gets the rows that have come so far.
  run(command, told = null) {
    const id = this.next++;
    return new Promise((resolve) => {
      if (!this.send({ do: command, id })) return resolve({ code: -1, rows: [], message: "not connected" });
      this.waiting.set(id, { resolve, rows: [], told });
    });
  }

  /// Ends what runs or waits.
  stop() {
    for (const id of this.waiting.keys()) this.send({ do: { command: "stop", id }, id: this.next++ });
  }

  received(event) {
    const one = this.waiting.get(event.id);
    if (!one) return;
    one.rows.push(...(event.rows ?? []));
    if (event.more) return one.told?.(one.rows);
    this.waiting.delete(event.id);
    one.resolve({ ...event, rows: one.rows });
  }

  /// The connection is gone, and with it the replies.
  lost() {
    for (const one of this.waiting.values()) one.resolve({ code: -1, rows: one.rows, message: "the connection was lost; what became of this is not known" });
    this.waiting.clear();
  }
}
