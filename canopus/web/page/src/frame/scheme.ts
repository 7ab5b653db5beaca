// Light or dark: as the system has it, unless it was chosen here.
const kept = "canopus scheme";

function chosen(): string | null {
  try {
    return localStorage.getItem(kept);
  } catch {
    return null;
  }
}

function show(scheme: string): void {
  const root = document.documentElement;
  root.dataset["ixTheme"] = "classic";
  root.dataset["ixColorSchema"] = scheme;
  root.style.colorScheme = scheme;
}

export function follow_scheme(): void {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const current = (): string => chosen() ?? (system.matches ? "dark" : "light");
  show(current());
  system.addEventListener("change", () => show(current()));
  document.addEventListener("click", (event) => {
    if (!event.composedPath().some((one) => one instanceof HTMLElement && one.dataset["scheme"] !== undefined)) return;
    const next = document.documentElement.dataset["ixColorSchema"] === "dark" ? "light" : "dark";
    try {
      localStorage.setItem(kept, next);
    } catch {
      // The browser keeps nothing.
    }
    show(next);
  }, true);
  // The description is at the side where there is room for it.
  let drawer: string | null = null;
  try {
    drawer = localStorage.getItem("canopus drawer");
  } catch {
    // The browser keeps nothing.
  }
  document.documentElement.dataset["drawer"] = drawer ?? (innerWidth >= 1600 ? "on" : "off");
}
