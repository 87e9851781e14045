(* SPDX-License-Identifier: BSD-3-Clause *)
(* fcl_artic_prove: the extracted checker (doc/PROVEN_CHECKER.md) on a world and its certificates. *)
module Integer = Z
open Checker
module Z = Integer

let help =
  {|fcl_artic_prove [options] WORLD CERTIFICATES...

Checks what certificates claim: that along a motion no two bodies that are checked come nearer than their margin. The
checker is proven in Coq, and extracted from there. doc/PROVEN_CHECKER.md says what is proven, and what is trusted.

  WORLD         the world's text
  CERTIFICATES  files of records

  --json        print everything as JSON, a document for each record, and one for the sum
  --quiet       print no line for a record that is proven
  --times       print the seconds that each record takes
  --work N      limit of work per record, in products of integers (default 1000000000)
  --help, --version

Exit: 0 all are proven, 1 something is not, 2 bad input, out of scope, or no record.
|}

let contents path =
  let c = open_in_bin path in
  let text = really_input_string c (in_channel_length c) in
  close_in c;
  text

(* a <= b *)
let leq a b =
  let e = Z.min a.exponent b.exponent in
  let whole x = Z.shift_left x.mantissa (Z.to_int (Z.sub x.exponent e)) in
  Z.leq (whole a) (whole b)

(* How many pairs the claim is about. A pair that every piece ignores to its end is not. *)
let pairs w m =
  let bodies = Array.of_list w.bodies and count = ref 0 and last = List.length m.pieces - 1 in
  let ends k = if k = last then m.until else { mantissa = Z.one; exponent = Z.zero } in
  let to_the_end i j k p = List.exists (fun ((a, b), u) -> a = i && b = j && leq (ends k) u) p.ignored in
  let all f = List.for_all (fun x -> x) (List.mapi f m.pieces) in
  Array.iteri
    (fun j b -> for i = 0 to j - 1 do if checked w m bodies.(i) b && not (all (to_the_end i j)) then incr count done)
    bodies;
  !count

type meeting = Nothing | Contact of string | Within_margin of string
type verdict = Proven of int * meeting | Not_proven of string | Bad of string

(* Whether the world has tolerances: then the claim is about all paths within them. *)
let is_tube w = w.off <> { of_variables = []; of_vectors = []; of_rotations = []; of_frames = []; of_bodies = [] }

(* Which part of the claim is not shown. *)
let fault w m =
  if not (is_meaningful w m) then "no rotation is near the nine numbers of some pose"
  else if not (reasons_ok w) then "some pair that is unchecked has not the reason that the world gives"
  else if not (pieces_join w m.pieces) then "the motion jumps between two pieces"
  else "some pair is not shown to be apart"

let verdict (known : Read.known) prepared hash limit (motion, proof) =
  let w = known.w in
  try
    Big.left := max_int;
    let m, of_world = Read.motion motion known in
    let of_motion, roots, contact = Read.proof proof known (List.length m.pieces) in
    Big.left := limit;
    if of_world <> hash then Not_proven "the motion is about another world"
    else if of_motion <> Sha256.of_string motion then Not_proven "the proof is about another motion"
    else
      let n = pairs w m in
      if n = 0 then Not_proven "nothing is checked: the claim is about no pair of bodies"
      else if not (accepts_prepared prepared w m roots) then Not_proven (fault w m)
      else
        match contact with
        | None -> Proven (n, Nothing)
        | Some c -> (
            let body k = Printf.sprintf "'%s' (body %d)" known.body.(k).body_name k in
            let both = body c.lower ^ " and " ^ body c.upper in
            let t = Z.to_float c.time.mantissa *. (2. ** Z.to_float c.time.exponent) in
            let text = Printf.sprintf "%s at t = %.17g of piece %d" both t c.piece in
            if not (accepts_meeting w m c.piece c.lower c.upper c.time c.of_lower c.witness) then
              Not_proven ("the witness does not show that " ^ both ^ " meet")
            else match c.witness with Near _ -> Proven (n, Within_margin text) | _ -> Proven (n, Contact text))
  with
  | Read.Bad_input why -> Bad ("bad input: " ^ why)
  | Read.Out_of_scope what -> Bad ("out of scope: " ^ what)
  | Big.Limit -> Not_proven "the limit of work is reached (--work)"
  | Stack_overflow | Out_of_memory -> Not_proven "memory is exhausted"

(* In quotes; bytes that do not print become \u00NN. *)
let quoted text =
  let out = Buffer.create 64 in
  let add c =
    if c = '"' || c = '\\' then Buffer.add_string out (Printf.sprintf "\\%c" c)
    else if c < ' ' || c > '~' then Buffer.add_string out (Printf.sprintf "\\u%04x" (Char.code c))
    else Buffer.add_char out c
  in
  Buffer.add_char out '"';
  String.iter add text;
  Buffer.add_char out '"';
  Buffer.contents out

(* Bytes that do not print become \xNN. *)
let shown text =
  String.concat "" (List.map (fun c -> if c < ' ' || c > '~' then Printf.sprintf "\\x%02x" (Char.code c) else String.make 1 c)
    (List.of_seq (String.to_seq text)))

let as_json tube v =
  let proven n more =
    Printf.sprintf {|{"proven": true, "pairs": %d%s%s}|} n (if tube then {|, "within_tolerances": true|} else "") more
  in
  match v with
  | Proven (n, Nothing) -> proven n ""
  | Proven (n, Contact what) -> proven n (Printf.sprintf {|, "contact": %s|} (quoted what))
  | Proven (n, Within_margin what) -> proven n (Printf.sprintf {|, "within_margin": %s|} (quoted what))
  | Not_proven why | Bad why -> Printf.sprintf {|{"proven": false, "reason": %s}|} (quoted why)

let as_text tube v =
  let proven n more = Printf.sprintf "proven, %d pairs%s%s" n (if tube then " within all tolerances" else "") more in
  match v with
  | Proven (n, Nothing) -> proven n ""
  | Proven (n, Contact what) -> proven n ("; and these meet: " ^ what)
  | Proven (n, Within_margin what) -> proven n ("; and these come within their margin: " ^ what)
  | Not_proven why -> "not proven: " ^ why
  | Bad why -> why

let fail why =
  prerr_endline ("fcl_artic_prove: " ^ shown why);
  exit 2

type asked = { mutable json : bool; mutable quiet : bool; mutable times : bool; mutable work : int; mutable files : string list }

let command () =
  let asked = { json = false; quiet = false; times = false; work = 1_000_000_000; files = [] } in
  let work text =
    if text = "" || String.length text > 18 || not (String.for_all (fun c -> c >= '0' && c <= '9') text) then
      fail "--work takes a number of products";
    asked.work <- int_of_string text
  in
  let rec go = function
    | [] -> ()
    | "--json" :: rest -> asked.json <- true; go rest
    | "--quiet" :: rest -> asked.quiet <- true; go rest
    | "--times" :: rest -> asked.times <- true; go rest
    | "--help" :: _ -> print_string help; exit 0
    | "--version" :: _ -> print_endline "fcl_artic_prove 1"; exit 0
    | "--work" :: number :: rest -> work number; go rest
    | [ "--work" ] -> fail "--work takes a value"
    | word :: rest when String.length word > 7 && String.sub word 0 7 = "--work=" ->
        work (String.sub word 7 (String.length word - 7));
        go rest
    | word :: _ when String.length word > 1 && word.[0] = '-' -> fail ("unknown option '" ^ word ^ "' (see --help)")
    | file :: rest -> asked.files <- file :: asked.files; go rest
  in
  go (List.tl (Array.to_list Sys.argv));
  asked.files <- List.rev asked.files;
  if List.length asked.files < 2 then fail "a world and certificates are needed (see --help)";
  asked

let () =
  let asked = command () in
  let proven = ref 0 and all = ref 0 and bad = ref false in
  let one (known : Read.known) prepared hash path alone k record =
    let begun = Sys.time () in
    let v = verdict known prepared hash asked.work record in
    let seconds = Sys.time () -. begun in
    incr all;
    (match v with Proven _ -> incr proven | Not_proven _ -> () | Bad _ -> bad := true);
    if asked.json then
      Printf.printf "{\"file\": %s, \"record\": %d, \"seconds\": %.6f, \"verdict\": %s}\n" (quoted path) k seconds (as_json (is_tube known.w) v)
    else begin
      let where = shown path ^ if alone then "" else Printf.sprintf ", record %d" k in
      (match v with Proven _ when asked.quiet -> () | _ -> Printf.printf "%s: %s\n" where (shown (as_text (is_tube known.w) v)));
      if asked.times then Printf.printf "%s: %.6f s\n" where seconds
    end
  in
  (try
     let text = contents (List.hd asked.files) in
     let hash = Sha256.hex (Sha256.of_string text) in
     let known = Read.world text in
     let prepared = prepare_world known.w in
     List.iter
       (fun path ->
         let records = Read.records (contents path) in
         if records = [] then fail ("'" ^ path ^ "' has no record: nothing is proven");
         List.iteri (one known prepared hash path (List.compare_length_with records 1 = 0)) records)
       (List.tl asked.files)
   with
  | Read.Bad_input why -> fail why
  | Read.Out_of_scope what -> fail ("out of scope: " ^ what)
  | Stack_overflow | Out_of_memory -> fail "memory is exhausted"
  | Sys_error why -> fail why);
  if asked.json then Printf.printf "{\"proven\": %d, \"records\": %d}\n" !proven !all
  else Printf.printf "%d of %d records proven\n" !proven !all;
  (try flush stdout with Sys_error _ -> fail "the output can't be written");
  exit (if !bad then 2 else if !proven = !all then 0 else 1)
