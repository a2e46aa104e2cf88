// Filters of the ledger by section and verdict. Without scripts the whole table stands as it is.
function filters(table) {
  const rows = [...table.querySelectorAll("tr[data-verdict]")];
  const form = document.createElement("form");
  form.className = "ledger-filters";
  const chosen = {};
  for (const name of ["section", "verdict"]) {
    const label = document.createElement("label");
    label.textContent = `${name} `;
    const select = document.createElement("select");
    select.name = name;
    select.add(new Option("all", ""));
    for (const value of new Set(rows.map((row) => row.dataset[name]))) select.add(new Option(value, value));
    select.addEventListener("change", show);
    chosen[name] = select;
    label.append(select);
    form.append(label);
  }
  const count = document.createElement("output");
  count.setAttribute("aria-live", "polite");
  form.append(count);
  form.addEventListener("submit", (event) => event.preventDefault());
  table.before(form);

  function show() {
    let shown = 0;
    for (const row of rows) {
      row.hidden = Object.entries(chosen).some(([name, { value }]) => value && row.dataset[name] !== value);
      shown += !row.hidden;
    }
    count.textContent = `${shown} of ${rows.length} claims`;
  }

  function visit() {  // a link to a row that is filtered out
    const row = rows.find((each) => each.id && location.hash === `#${each.id}`);
    if (row?.hidden) {
      for (const select of Object.values(chosen)) select.value = "";
      show();
      row.scrollIntoView();
    }
  }

  show();
  window.addEventListener("hashchange", visit);
}

document.querySelectorAll("table.ledger").forEach(filters);
