// A line of a filter with completion: CodeMirror in a shadow root, where it adopts its style sheets instead of writing <style> elements.
import { acceptCompletion, autocompletion, completionKeymap, startCompletion, type CompletionContext, type CompletionResult } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { EditorState, Prec } from "@codemirror/state";
import { EditorView, keymap, placeholder, tooltips } from "@codemirror/view";

export interface Suggestion {
  /** What is written. */
  text: string;
  detail: string;
}

/** Something of a term is written before the cursor: Tab completes it. Else Tab leads on, as everywhere. */
const is_in_term = (view: EditorView): boolean => /\S$/.test(view.state.sliceDoc(0, view.state.selection.main.head));

export class FilterInput extends HTMLElement {
  private view: EditorView | null = null;
  private given = "";
  label = "Filter";
  hint = "";
  /** For the term before the cursor ("node=se"): what it may become. */
  suggest: (term: string) => Suggestion[] = () => [];
  changed: (text: string) => void = () => undefined;

  set value(text: string) {
    this.given = text;
    const { view } = this;
    if (view && view.state.doc.toString() !== text && !view.hasFocus) view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: text } });
  }

  get value(): string {
    return this.view?.state.doc.toString() ?? this.given;
  }

  override focus(): void {
    this.view?.focus();
  }

  connectedCallback(): void {
    queueMicrotask(() => { if (this.isConnected && !this.view) this.make(); });
  }

  disconnectedCallback(): void {
    this.view?.destroy();
    this.view = null;
  }

  private complete(context: CompletionContext): CompletionResult | null {
    const term = context.matchBefore(/[^\s]*/);
    if (!term || (term.from === term.to && !context.explicit)) return null;
    const not = term.text.startsWith("!") ? 1 : 0;
    const options = this.suggest(term.text.slice(not)).map((one) => ({ label: one.text, detail: one.detail, type: "keyword" }));
    return options.length ? { from: term.from + not, options, filter: false } : null;
  }

  private make(): void {
    const root = this.shadowRoot ?? this.attachShadow({ mode: "open" });
    this.view = new EditorView({
      root, parent: root as unknown as HTMLElement,
      state: EditorState.create({ doc: this.given, extensions: [
        Prec.highest(keymap.of([{ key: "Tab", run: (view) => is_in_term(view) && acceptCompletion(view) }])),
        Prec.low(keymap.of([{ key: "Enter", run: () => true }])),
        keymap.of([...completionKeymap, ...historyKeymap, ...defaultKeymap]),
        history(), placeholder(this.hint), tooltips({ position: "fixed" }),
        autocompletion({ override: [(context) => this.complete(context)], activateOnTyping: true, icons: false }),
        EditorState.transactionFilter.of((change) => (change.newDoc.lines > 1 ? [] : change)),
        EditorView.contentAttributes.of({ "aria-label": this.label, spellcheck: "false", maxlength: "1000" }),
        EditorView.updateListener.of((update) => { if (update.docChanged) this.changed(update.state.doc.toString()); }),
        EditorView.domEventHandlers({ focus: (_, view) => { if (view.state.doc.length === 0) startCompletion(view); } }),
        EditorView.theme({
          "&": { height: "32px", border: "1px solid var(--theme-color-std-bdr)", borderRadius: "4px", backgroundColor: "var(--field-background)", color: "var(--theme-color-std-text)" },
          "&.cm-focused": { outline: "2px solid var(--theme-color-focus-bdr)", outlineOffset: "1px" },
          ".cm-scroller": { fontFamily: "inherit", lineHeight: "30px", overflow: "hidden" },
          ".cm-content": { padding: "0 4px", caretColor: "var(--theme-color-std-text)" },
          ".cm-line": { padding: "0 4px" },
          ".cm-cursor": { borderLeftColor: "var(--theme-color-std-text)" },
          ".cm-placeholder": { color: "var(--theme-color-soft-text)" },
          ".cm-tooltip": { backgroundColor: "var(--theme-color-2)", color: "var(--theme-color-std-text)", border: "1px solid var(--theme-color-std-bdr)", borderRadius: "4px", zIndex: "2000" },
          ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "inherit", maxHeight: "40vh" },
          ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { padding: "4px 8px" },
          ".cm-tooltip-autocomplete ul li[aria-selected]": { backgroundColor: "var(--theme-color-ghost--selected)", color: "inherit" },
          ".cm-completionDetail": { color: "var(--theme-color-soft-text)", fontStyle: "normal", marginLeft: "12px" },
        }),
      ] }),
    });
  }
}

customElements.define("filter-input", FilterInput);
