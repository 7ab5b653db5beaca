// What there is to begin with, where the page has no plant and no project: a built-in plant, those of the folder, a new project, settings of modules.
import { make, set_text } from "./dom.js";

export class StartView {
  constructor(section, commands) {
    this.section = section;
    this.commands = commands;
    [this.said, this.plants, this.projects, this.folder, this.try_button, this.form, this.name] =
      ["start-said", "start-plants", "start-projects", "start-folder", "start-try", "start-new", "start-name"].map((id) => section.querySelector(`#${id}`));
    this.try_button.addEventListener("click", () => this.open({ command: "open" }));
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.open({ command: "new project", name: this.name.value.trim() });
    });
    [this.settings, this.settings_form, this.settings_name, this.model] = ["start-settings", "start-new-settings", "start-settings-name", "start-model"].map((id) => section.querySelector(`#${id}`));
    this.settings_form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.open({ command: "new settings", name: this.settings_name.value.trim(), model: this.model.value });
    });
    [this.copy_form, this.copied, this.copy_name, this.recent, this.exit_button] =
      ["start-save-as", "start-copied", "start-copy-name", "start-recent", "start-exit"].map((id) => section.querySelector(`#${id}`));
    this.copy_form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.open({ command: "save as", path: this.copied.value, name: this.copy_name.value.trim() });
    });
    this.exit_button.addEventListener("click", () => this.ask_exit());
  }

  /// The program ends, and with it all that was opened here.
  ask_exit() {
    const dialog = make("dialog", { "aria-label": "Exit" });
    const [yes, no] = [make("button", { type: "button" }, "Yes"), make("button", { type: "button" }, "No")];
    yes.addEventListener("click", async () => {
      dialog.close();
      const done = await this.commands.run({ command: "exit" });
      this.say(done.code === 0 ? "the program ends" : done.message ?? "no answer", done.code === 0 ? "" : "error");
    });
    no.addEventListener("click", () => dialog.close());
    dialog.addEventListener("close", () => dialog.remove());
    dialog.append(make("h2", {}, "Exit"), make("p", {}, "The program ends, and with it whatever runs below it."), make("p", { class: "ways" }, yes, no));
    this.section.append(dialog);
    dialog.showModal();
    no.focus();
  }

  say(text, mood = "") {
    this.said.dataset.mood = mood;
    set_text(this.said, text);
  }

  /// What has been opened runs until it is ended here, or this page's program ends.
  list_running(running) {
    this.section.querySelector("#start-running-part").hidden = running.length === 0;
    this.section.querySelector("#start-running").replaceChildren(...running.map(({ number, path }) => {
      const name = path || "the built-in plant";
      const word = path.endsWith(".xml") ? "Close" : "End";
      const end = make("button", { type: "button", "aria-label": `${word} ${name}` }, word);
      end.disabled = !this.may_open;
      end.addEventListener("click", async () => {
        end.disabled = true;
        const done = await this.commands.run({ command: "end", number });
        set_text(this.said, done.code === 0 ? `${name} ends` : done.message ?? "no answer");
        end.closest("li").remove();
      });
      return make("li", {}, name, " ", end);
    }));
  }

  async greeted(hello) {
    this.section.hidden = !hello.offers.includes("plants");
    if (this.section.hidden) return;
    // The bus that a run has at least is none that anybody wants to see.
    for (const section of document.querySelectorAll("main > section")) section.hidden = section !== this.section;
    this.may_open = hello.role === "configure";
    for (const one of [this.try_button, this.name, this.form.querySelector("button"), this.settings_name, this.model, this.settings_form.querySelector("button"),
      this.copied, this.copy_name, this.copy_form.querySelector("button"), this.exit_button]) one.disabled = !this.may_open;
    const done = await this.commands.run({ command: "plants" });
    if (done.code !== 0) return set_text(this.said, done.message ?? "");
    const [found] = done.rows;
    set_text(this.folder, found.folder);
    this.list(this.plants, found.plants, "no plant file in this folder");
    this.list(this.projects, found.projects, "no project in this folder");
    this.list(this.settings, found.settings, "no settings of a module in this folder");
    this.list_running(found.running);
    this.copy_form.hidden = found.settings.length === 0;
    this.copied.replaceChildren(...found.settings.map((path) => make("option", {}, path)));
    await this.list_recent();
  }

  /// Nobody else's business: those who only look are not told.
  async list_recent() {
    if (!this.may_open) return;
    const done = await this.commands.run({ command: "recent projects" });
    const paths = done.code === 0 ? done.rows[0].recent : [];
    this.section.querySelector("#start-recent-part").hidden = paths.length === 0;
    this.list(this.recent, paths, "");
  }

  list(list, paths, none) {
    list.replaceChildren(...paths.map((path) => {
      const button = make("button", { type: "button", class: "plain" }, path);
      button.disabled = !this.may_open;
      button.addEventListener("click", () => this.open({ command: "open", path }));
      return make("li", {}, button);
    }));
    if (paths.length === 0) list.replaceChildren(make("li", { class: "faint" }, none));
  }

  /// It is a page of its own.
  async open(command) {
    this.say("starts …");
    const done = await this.commands.run(command);
    if (done.code === 0 && /^http:\/\/(127\.0\.0\.1|\[::1\]):\d+\//.test(done.rows[0].url)) return location.assign(done.rows[0].url);
    this.say(done.message || "it did not start", "error");
  }
}
