// Device files that somebody drops or chooses become nodes of a project; each gets a free node-ID.
import type { App } from "../frame/app.js";
import type { Project } from "../store/project.js";

export const device_file_types = ".eds,.dcf,.xdd,.xml";
export const largest_device_file = 1_500_000;

export async function add_device_files(app: App, project: Project, files: readonly File[]): Promise<void> {
  for (const file of files) {
    if (file.size > largest_device_file) {
      app.say(`${file.name} is larger than 1.5 MB, which is too large for the page`, "error");
      continue;
    }
    const done = await app.change(project, { command: "project add", file: { name: file.name, text: await file.text() } });
    const added = done.rows.find((row) => row["event"] === "added");
    if (added) app.say(`${String(added["name"] || file.name)} added to the project as node ${String(added["node"])}`);
  }
}
