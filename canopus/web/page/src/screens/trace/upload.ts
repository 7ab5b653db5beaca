// A trace file of the browser's machine, sent to the run in parts; each waits for the reply to the one before.
import type { Command, Done } from "../../store/commands.js";

const part = 128 * 1024;  // bytes, of which each turn of the run takes one
const most_bytes = 128 * 1024 * 1024;

export const too_long = (name: string, size: number): string => (size > most_bytes ? `${name}: ${Math.ceil(size / 1024 ** 2)} MiB; a trace file from this computer has at most ${most_bytes / 1024 ** 2} MiB` : size === 0 ? `${name}: the file is empty` : "");

function base64(bytes: Uint8Array): string {
  let text = "";
  for (let at = 0; at < bytes.length; at += 0x8000) text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
  return btoa(text);
}

/** Its number for `open trace`, or what became of the command that failed. `progress`: bytes that have come. */
export async function upload(file: Blob & { name: string }, run: (command: Command) => Promise<Done>, progress: (bytes: number) => void): Promise<{ upload: number } | Done> {
  const begun = await run({ command: "upload trace", name: file.name, size: file.size });
  if (begun.code !== 0) return begun;
  const { upload: number } = begun.rows[0] as { upload: number };
  for (let at = 0; at < file.size; at += part) {
    const bytes = new Uint8Array(await file.slice(at, at + part).arrayBuffer());
    const taken = await run({ command: "upload part", upload: number, data: base64(bytes) });
    if (taken.code !== 0) return taken;
    progress(at + bytes.length);
  }
  return { upload: number };
}
