// Commands to the server and their replies.
import type { Reply } from "./protocol.js";

export interface Command {
  command: string;
  [field: string]: unknown;
}

/** What became of a command. `code` 0: done; -1: there is no connection. */
export interface Done {
  code: number;
  rows: Record<string, unknown>[];
  message: string;
  command: string;
  file?: string;
  t: number;
}

interface Waiting {
  resolve: (done: Done) => void;
  rows: Record<string, unknown>[];
  progress: ((rows: Record<string, unknown>[]) => void) | null;
}

/** What the command line says of its options has no place on the page: the page has fields. */
export function without_options(message: string): string {
  if (message.includes("--type")) return "Choose a type.";
  const kept = message.split(/(?<=[.?!]) +/).filter((sentence) => !/(^|[\s(])--[a-z]/.test(sentence)).join(" ");
  return kept || (message ? "It was refused." : "");
}

export class Commands {
  private next = 1;
  private waiting = new Map<number, Waiting>();

  /** `send`: takes a message for the server; false when there is no connection. */
  constructor(private readonly send: (message: unknown) => boolean) {}

  /** Never rejects. `progress` gets the rows that have come so far. */
  run(command: Command, progress: ((rows: Record<string, unknown>[]) => void) | null = null): Promise<Done> {
    const id = this.next++;
    return new Promise((resolve) => {
      if (!this.send({ do: command, id })) return resolve({ code: -1, rows: [], message: "not connected", command: "", t: 0 });
      this.waiting.set(id, { resolve, rows: [], progress });
    });
  }

  /** Stops those that run or wait and have `progress`: what looks on by itself is not stopped. */
  stop(): void {
    for (const [id, one] of this.waiting) if (one.progress) this.send({ do: { command: "stop", id }, id: this.next++ });
  }

  get is_running(): boolean {
    return [...this.waiting.values()].some((one) => one.progress !== null);
  }

  received(event: Reply): void {
    const one = this.waiting.get(event.id);
    if (!one) return;
    one.rows.push(...(event.rows ?? []));
    if (event.more) return one.progress?.(one.rows);
    this.waiting.delete(event.id);
    // Fields of `hello` and `arm` stand in the reply itself.
    one.resolve({ ...event, code: event.code ?? 0, rows: one.rows, message: without_options((event.message ?? "").replace(/^canopus[a-z0-9 -]*: /, "")), command: event.command ?? "" });
  }

  /** The connection is gone, and with it the replies. */
  lost(): void {
    for (const one of this.waiting.values()) one.resolve({ code: -1, rows: one.rows, message: "the connection was lost; what became of this is not known", command: "", t: 0 });
    this.waiting.clear();
  }
}
