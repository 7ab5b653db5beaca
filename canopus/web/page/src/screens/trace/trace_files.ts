// Trace files of the folder, or of the browser's machine: one is opened in place of what runs, and closed again.
import type { App } from "../../frame/app.js";
import type { MenuItem } from "../../frame/menu.js";
import { count_text } from "../../store/nodes.js";
import type { Command } from "../../store/commands.js";
import { too_long, upload } from "./upload.js";

interface Listed {
  folder: string;
  files: { path: string; size: number }[];
}

export interface OpenTrace {
  file: number;
  path: string;
  records: number;
  format: string;
  buses: string[];
  left_out?: number;
  message?: string;
}

export const size_text = (bytes: number): string => (bytes < 1024 ? `${bytes} B` : bytes < 1024 ** 2 ? `${Math.round(bytes / 1024)} KiB` : `${(bytes / 1024 ** 2).toFixed(1)} MiB`);

export class TraceFiles {
  open: OpenTrace | null = null;

  constructor(private readonly app: App, private readonly changed: () => void) {}

  get are_offered(): boolean {
    return this.app.store.offers("open trace") && this.app.store.may_operate;
  }

  /** Those of the folder, and the way back to the run. */
  async items(): Promise<MenuItem[]> {
    const done = await this.app.connection.commands.run({ command: "trace files" });
    if (done.code !== 0) {
      this.app.say(done.message, "error");
      return [];
    }
    const { files, folder } = done.rows[0] as unknown as Listed;
    if (files.length === 0 && !this.are_taken) this.app.say(`no trace file in ${folder}`, "error");
    return [...(this.open ? [{ title: "Back to this run", run: () => void this.close() }] : []), ...(this.are_taken ? [{ title: "From this computer …", run: () => this.choose() }] : []),
      ...files.map((one) => ({ title: one.path, detail: size_text(one.size), run: () => void this.show({ path: one.path }) }))];
  }

  /** Those of the browser's machine. */
  get are_taken(): boolean {
    return this.app.store.offers("upload trace") && this.app.store.may_operate;
  }

  private choose(): void {
    const input = document.createElement("input");
    input.type = "file";
    input.accept = ".log,.pcapng,.pcap,.asc,.trc,.blf,.csv,.txt,*";
    input.addEventListener("change", () => { if (input.files?.[0]) void this.take(input.files[0]); });
    input.click();
  }

  /** A file that was chosen or dropped. */
  async take(file: File): Promise<void> {
    const problem = too_long(file.name, file.size);
    if (problem) return this.app.say(problem, "error");
    const { app } = this;
    const sent = await upload(file, (command) => app.connection.commands.run(command), (bytes) => app.say(`${file.name}: ${Math.floor((100 * bytes) / file.size)} % sent`));
    if ("upload" in sent) await this.show({ upload: sent.upload });
    else app.say(sent.message, "error");
  }

  private async show(which: Omit<Command, "command">): Promise<void> {
    const done = await this.app.run({ command: "open trace", ...which }, { done: "" });
    if (done.failed) return;
    await this.close();
    this.open = done.rows[0] as unknown as OpenTrace;
    const { path, records, left_out, message } = this.open;
    this.app.say(`${path}: ${count_text(records, "frame")}${left_out ? `, ${left_out} older ones left out` : ""}${message ? `; ${message}` : ""}`, message ? "error" : "");
    this.changed();
  }

  async close(): Promise<void> {
    const { open } = this;
    if (!open) return;
    this.open = null;
    await this.app.connection.commands.run({ command: "close trace", file: open.file });
    this.changed();
  }
}
