// Style sheets come as texts: import style from "./motion.css" with { type: "text" }.
declare module "*.css" {
  const text: string;
  export default text;
}
